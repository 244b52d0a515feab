#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "perception/state.h"

namespace gusset {

/// A point of the image and where it lies in the world. Pixels are those of a 640x480 frame (of the
/// 340x340 ROI where only that was seen), pixel (0, 0) being the top-left pixel's centre.
struct PosePoint {
  cv::Point2d px;
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< m; on the surface that the camera sees there.
  bool from_depth = false;                        ///< False: no depth there; p_W lies on the table.
};

/// Side of the body at which the mouth is. Unit vectors; those in the world are horizontal.
struct Rim {
  cv::Point2d outward_px;     ///< The way the mouth looks.
  Eigen::Vector3d outward_W;  ///< The same.
  Eigen::Vector3d along_W;    ///< Across it, from corners[0] towards corners[1].
};

/// The mouth's two lips: the labels nearest the rim, and those that were drawn back onto the body.
struct Lips {
  PosePoint near;   ///< Middle of the labels nearest the rim.
  PosePoint drawn;  ///< Middle of the labels farthest from it.
};

/// How wide the mouth is (MouthWidth).
struct Width {
  double radius_px = 0;            ///< Of the largest disc that finds room in it.
  double length_px = 0;            ///< From end to end.
  std::array<PosePoint, 2> sides;  ///< Its lips on either side of its middle, across its length.
  /// False: its labels do not go round it (GoesRound), or table shows within them (kTableShare), so
  /// part of what is measured is no mouth.
  bool closed = true;
};

/// The cube as seen.
struct CubeSeen {
  cv::Point2d px;  ///< Centroid of what shows of its top face, or of all red pixels without depth.
  Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< Centre of the cube, m, cloth over it or not.
  cv::Point2d centre_px;                          ///< Where the camera has that.
  double yaw_rad = 0;                             ///< Of an edge about world z, in [-pi/4, pi/4).
  double area_px2 = 0;                            ///< Red pixels.
  bool in_roi = false;
  bool on_bag = false;      ///< Amid its cloth, in it or on top; else it stands beside it.
  bool from_depth = false;  ///< False: taken to stand on the table.
};

/// What one frame says; a function of that frame alone. Every number is finite.
struct Observation {
  State state = State::kSuccess;
  bool cube_hidden = false;       ///< s3 because a full frame shows no cube.
  bool has_surroundings = false;  ///< False: a bare ROI was seen; px then count from its corner.
  cv::Rect roi;                   ///< In the pixels used here.

  bool bag_seen = false;
  bool bag_at_border = false;  ///< Cut by the edge of the region of interest.
  bool mouth_seen = false;     ///< At least three labels.
  bool piece = false;          ///< The cube is seen inside the ROI.
  double A_bag = 0;            ///< px^2.
  double A_o = 0;              ///< Algorithm 7, area of the union, px^2.

  cv::Point2d bag_centroid;  ///< px; this and corners mean nothing unless bag_seen.
  /// Four-sided outline of the body, counter-clockwise as one sees the image. In s1-s3 the rim runs
  /// from corners[0] to corners[1]; in s0 corners[0] is the one nearest the image's upper right.
  std::array<cv::Point2d, 4> corners;
  std::optional<Rim> rim;  ///< Set where corners count from the rim.

  /// Centroids, px; with perception.mouth = "depth" points of hem in their place.
  std::vector<cv::Point2d> labels;
  PosePoint opening_centre;                    ///< Centroid of the union; of the labels if A_o = 0.
  double opening_radius_px = 0;                ///< sqrt(A_o / pi).
  std::array<cv::Point2d, 4> opening_corners;  ///< Quadrilateral of the labels; only in s2.

  std::optional<Lips> lips;    ///< Set where the rim and the mouth are seen.
  std::optional<Width> width;  ///< Set in s2.

  std::optional<CubeSeen> cube;

  /// Pose points, row by row from the rim (s0: from the upper right), each row from the side of
  /// corners[0]. s0: 9 to grasp. s1: 9 along the rim to grasp, 9 on the body to drag to. s2: 9 in
  /// the opening to place at (the cube is grasped). s3: 81 to grasp. s4, s5: none.
  std::vector<PosePoint> grasp_points;
  std::vector<PosePoint> place_points;
  /// The bag's edge on the side of each of grasp_points; only in s0.
  std::vector<PosePoint> edge_points;

  std::vector<std::string> warnings;
};

}  // namespace gusset
