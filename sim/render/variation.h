#pragma once

#include <cstdint>
#include <vector>

#include "perception/camera_model.h"
#include "sim/render/scene_view.h"

namespace gusset {

/// How far frames may differ from the nominal scene's, to see what perception can bear. Each value
/// is the most that happens at amount 1. What perception is told (camera model, thresholds) and
/// ground truth stay nominal, but for the number of labels, which the bag truly has. The world does
/// not notice: clutter is seen, not touched.
struct VariationConfig {
  double amount = 0;  ///< Scales all that follows; 0: none.
  int seed = 0;       ///< Of the series; each restored world draws from it and its sensor seed.

  double camera_mm = 3;   ///< Camera off its place by at most this, and turned
  double camera_deg = 1;  ///< by at most this, about any axis.
  double azimuth_deg = 180;
  double elevation_deg = 15;
  double light = 0.12;         ///< Brightness of the light, as a share;
  double light_colour = 0.06;  ///< of its red and blue against green.
  double contrast = 0.1;       ///< Of contrast, shadow and unevenness, added.
  double bag_colour = 0.06;    ///< Added to each channel (0..1); as much again to all.
  double label_colour = 0.06;
  int labels_missing = 1;      ///< Labels fewer per layer, but three at least remain.
  double canvas_colour = 0.3;  ///< As a share. Its folds lie elsewhere, too.
  int clutter = 4;             ///< Blocks on the table outside the region of interest.
  /// False, at any amount: no labels are drawn. Ground truth still goes by where they would be.
  bool labels_drawn = true;

  template <class V>
  void Fields(V& v) {
    v("amount", amount, {0, 1});
    v("seed", seed, {0, 2147483647});
    v("camera_mm", camera_mm, {0, 50});
    v("camera_deg", camera_deg, {0, 10});
    v("azimuth_deg", azimuth_deg, {0, 180});
    v("elevation_deg", elevation_deg, {0, 60});
    v("light", light, {0, 0.5});
    v("light_colour", light_colour, {0, 0.5});
    v("contrast", contrast, {0, 0.5});
    v("bag_colour", bag_colour, {0, 0.5});
    v("label_colour", label_colour, {0, 0.5});
    v("labels_missing", labels_missing, {0, 17});
    v("canvas_colour", canvas_colour, {0, 1});
    v("clutter", clutter, {0, 20});
    v("labels_drawn", labels_drawn);
  }
};

/// A block that lies on the table.
struct Clutter {
  TriMesh mesh;
  Eigen::Isometry3d X_WM;
  Eigen::Vector3f rgb;
};

/// The look of what may vary.
struct SceneLook {
  LightConfig light;
  Eigen::Vector3f bag_rgb, label_rgb, canvas_rgb;
  int labels_per_layer = 0;
  std::uint64_t canvas_seed = kCanvasSeed;
  /// Pose of the true camera in the nominal camera's frame.
  Eigen::Isometry3d X_CD = Eigen::Isometry3d::Identity();
  std::vector<Clutter> clutter;
};

/// One draw. The same look for the same arguments; `nominal` itself, to the bit, at amount 0.
/// @param cube_m where the cube is (x, y; world frame): no clutter lies there.
SceneLook Vary(const SceneLook& nominal, const VariationConfig& config,
               const Eigen::Vector2d& cube_m, std::uint64_t seed);

}  // namespace gusset
