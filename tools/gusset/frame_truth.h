#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "agents/ports/referee.h"

namespace gusset {

/// Ground truth of what the camera sees now, for labelled frames. Pixels are the frame's.
struct FrameTruth {
  Truth truth;
  int labels_seen = 0;                               ///< In the region of interest.
  std::vector<double> label_px2;                     ///< What each label shows there.
  std::vector<cv::Point2d> label_centre_px;          ///< And its middle; of no label that is 0.
  int cube_px = 0;                                   ///< Pixels that show the cube.
  bool cube_hidden = false;                          ///< Fewer than perception needs.
  Eigen::Vector3d cube_m = Eigen::Vector3d::Zero();  ///< The cube's centre, world.
  /// CV_8UC3, as large as the frame: what each pixel shows (a Shown), how far from the rim the
  /// cloth there is, in units of kRimStep_m, and 255 where it is a label.
  cv::Mat surface;
};

/// Unit of FrameTruth::surface's second channel; 255 steps reach farther than any bag is deep.
inline constexpr double kRimStep_m = 0.002;

}  // namespace gusset
