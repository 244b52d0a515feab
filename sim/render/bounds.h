#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

namespace gusset {

/// A box's corners, one a column; metres.
using Corners = Eigen::Matrix<float, 3, 8>;

/// Axis-aligned box, metres.
struct Bounds {
  Eigen::Vector3f lo = Eigen::Vector3f::Zero(), hi = lo;

  /// Of points; the origin if there are none.
  static Bounds Of(const std::vector<Eigen::Vector3f>& points);
  Corners corners() const;
};

/// False only if the whole box is beyond one of the view's sides.
bool MayBeSeen(const Corners& box, const Eigen::Matrix4f& clip_from_world);

/// The pixels that a box may show in: of an image of that size whose row 0 is OpenGL's lowest. All
/// of them if part of the box is not in front of the camera.
cv::Rect PixelsOf(const Corners& box, const Eigen::Matrix4f& clip_from_world, cv::Size size);

}  // namespace gusset
