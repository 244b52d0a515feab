#pragma once

#include <string>
#include <vector>

#include "base/config.h"

namespace gusset {

/// How perception looks at a frame. Colours are OpenCV's HSV (H 0..179, S and V 0..255), bounds
/// inclusive, {H, S, V}; where the lower H exceeds the upper one the range wraps through red.
/// Colour ranges and noise floors: tuned 2026-11 on the panels of the thesis's figure 5.2 and on
/// rendered frames (tests/perception/). Lengths and areas in px are those of a 640x480 frame.
struct PerceptionConfig {
  int roi_x = 150;     ///< Left column of the region of interest.
  int roi_y = 70;      ///< Top row.
  int roi_side = 340;  ///< Columns 150..489, rows 70..409.

  std::vector<double> bag_hsv_min = {0, 0, 45};  ///< Cream and white cloth, down into its creases.
  std::vector<double> bag_hsv_max = {179, 107, 255};
  /// The canvas's brightness follows the light, so cloth must also be this many times as bright as
  /// the ROI's median V (the canvas: a flat bag covers 30 %); capped by bag_v_cap.
  double bag_over_canvas = 2.2;
  double bag_v_cap = 120;
  std::vector<double> label_hsv_min = {28, 75, 45};  ///< Yellow-green.
  std::vector<double> label_hsv_max = {54, 255, 255};
  std::vector<double> cube_hsv_min = {170, 130, 60};  ///< Red, wraps.
  std::vector<double> cube_hsv_max = {12, 255, 255};

  double bag_min_px2 = 1000;   ///< Below: no bag. Folded bags start at 7,000.
  double bag_max_px2 = 70000;  ///< Above: not a bag but a table; twice the flat Bag 1.
  double hole_max_px2 = 1200;  ///< Larger holes in the cloth show canvas; smaller ones are creases.
  double label_min_px2 = 10;   ///< A label facing the camera covers 55.
  /// A label of 12 x 14 mm is 8.1 px long, by its second moment; a larger spot than a label that is
  /// longer than this is several. Tuned 2026-11 on 118 rendered frames: single labels up to 9.0 px
  /// (JPEG: 9.4), two that touch from 9.0 px (tests/perception/labels_test.cc).
  double label_length_px = 9.2;
  double label_inset_px = 4;  ///< A label's middle lies so far inside the rim: half of 14 mm.
  /// What the mouth is found by: its labels, or the hem of its lips in depth and shading
  /// (mouth_by_depth.h), for bags that have none. What follows was tuned with that file.
  std::string mouth = "labels";
  double hem_min_px = 4;   ///< A hem's width, 12 mm: 6.9 px; less where the cloth is tilted,
  double hem_max_px = 9;   ///< more where it is near the camera.
  double hem_dip = 0.010;  ///< Its stitching is darker than both sides by at least this share.
  double hem_step_mm = 2;  ///< At a lip on the bag, depth falls by at least this.
  double hem_min_length_px = 12;  ///< Shorter pieces are chance.
  double hem_spacing_px = 15;     ///< One point per so much of a lip.
  double rim_reach_px = 20;       ///< Cloth around a label within this tells where the rim is.
  double cube_min_px2 = 90;       ///< A fifth of the cube's face (408).
  double cube_max_px2 = 1500;     ///< The cube seen from the side covers 650.
  double place_inset_px = 18;  ///< Where the cube is placed it clears both lips: half its diagonal,
                               ///< 14.3, and the half of a label that covers the lip beyond.
  /// Pose points stay this far inside the cloth's edge: a camera one degree off its calibration
  /// moves the picture by up to 11 px. Tuned 2026-11 for 99 % of points on cloth over a corpus with
  /// varied cameras (docs/perception.md); with 4, 97.4 % of s0's edge points were.
  double point_inset_px = 6;

  double edge_cone_deg = 25;  ///< In s0 a grasp is at the bag's edge this near a pose point's side,
  double edge_inset_px = 9;   ///< 15 mm inside it (docs/primitives.md),
  double edge_central_px = 15;  ///< unless the point is this near the middle: that one has no side.

  double cube_side_m = 0.035;
  double table_height_m = 0;  ///< Where a pixel without depth is assumed to be.
  double depth_min_m = 0.3;   ///< Depths outside [min, max] are no measurement.
  double depth_max_m = 1.5;
  int depth_window_px = 5;  ///< Side of the square whose median is a pixel's depth; odd.

  template <class V>
  void Fields(V& v) {
    v("roi_x", roi_x, Range{0, 639});
    v("roi_y", roi_y, Range{0, 479});
    v("roi_side", roi_side, Range{32, 480});
    v("bag_hsv_min", bag_hsv_min, Range{0, 255});
    v("bag_hsv_max", bag_hsv_max, Range{0, 255});
    v("bag_over_canvas", bag_over_canvas, Range{1, 10});
    v("bag_v_cap", bag_v_cap, Range{0, 255});
    v("label_hsv_min", label_hsv_min, Range{0, 255});
    v("label_hsv_max", label_hsv_max, Range{0, 255});
    v("cube_hsv_min", cube_hsv_min, Range{0, 255});
    v("cube_hsv_max", cube_hsv_max, Range{0, 255});
    v("bag_min_px2", bag_min_px2, Range{1, 1e6});
    v("bag_max_px2", bag_max_px2, Range{1, 1e6});
    v("hole_max_px2", hole_max_px2, Range{0, 1e6});
    v("label_min_px2", label_min_px2, Range{1, 1e4});
    v("label_length_px", label_length_px, Range{3, 100});
    v("label_inset_px", label_inset_px, Range{0, 50});
    v("mouth", mouth, {"labels", "depth"});
    v("hem_min_px", hem_min_px, Range{1, 10});
    v("hem_max_px", hem_max_px, Range{1, 10});
    v("hem_dip", hem_dip, Range{0.001, 0.5});
    v("hem_step_mm", hem_step_mm, Range{0.5, 100});
    v("hem_min_length_px", hem_min_length_px, Range{1, 500});
    v("hem_spacing_px", hem_spacing_px, Range{5, 500});
    v("rim_reach_px", rim_reach_px, Range{3, 100});
    v("cube_min_px2", cube_min_px2, Range{1, 1e5});
    v("cube_max_px2", cube_max_px2, Range{1, 1e5});
    v("place_inset_px", place_inset_px, Range{0, 100});
    v("point_inset_px", point_inset_px, Range{0, 20});
    v("edge_cone_deg", edge_cone_deg, Range{0, 90});
    v("edge_inset_px", edge_inset_px, Range{0, 50});
    v("edge_central_px", edge_central_px, Range{0, 100});
    v("cube_side_m", cube_side_m, Range{0.005, 0.2});
    v("table_height_m", table_height_m, Range{-1, 1});
    v("depth_min_m", depth_min_m, Range{0.05, 10});
    v("depth_max_m", depth_max_m, Range{0.05, 10});
    v("depth_window_px", depth_window_px, Range{1, 31});
  }
};

/// What tells a bag's states apart; areas in px^2 of the 640x480 frame. Each bag's file carries
/// [thresholds] and, to the letter of Table 5.3, [thresholds_published]. Defaults: Bag 1. Its A_oth
/// is the 700 that the authors' code ran with: the printed 150 is a third of the cube's own face.
struct BagThresholds {
  double A_th = 25000;    ///< Up to here the bag counts as folded.
  double A_oth = 700;     ///< Above, the opening takes the cube.
  double A_bmax = 34000;  ///< Bag area that earns reward 1.
  double A_omax = 3900;   ///< Opening area that earns reward 1.
  double A_flat = 34950;  ///< The bag laid flat.
  int labels_per_layer = 5;

  template <class V>
  void Fields(V& v) {
    v("A_th", A_th, Range{0, 1e6});
    v("A_oth", A_oth, Range{0, 1e6});
    v("A_bmax", A_bmax, Range{1, 1e6});
    v("A_omax", A_omax, Range{1, 1e6});
    v("A_flat", A_flat, Range{1, 1e6});
    v("labels_per_layer", labels_per_layer, Range{2, 50});
  }
};

}  // namespace gusset
