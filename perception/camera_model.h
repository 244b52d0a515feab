#pragma once

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

namespace gusset {

/// Pinhole intrinsics in pixels. Pixel (0, 0) is the top-left pixel's centre.
struct Pinhole {
  double fx = 615;
  double fy = 615;
  double cx = 320;
  double cy = 240;
  int width = 640;
  int height = 480;
};

/// A calibrated camera. Camera frame C: x right, y down, z forward (OpenCV's convention).
struct CameraModel {
  Pinhole pinhole;
  Eigen::Isometry3d X_WC = Eigen::Isometry3d::Identity();  ///< Pose of C in the world, metres.

  /// World point (m) to pixel. The point must lie in front of the camera.
  cv::Point2d Project(const Eigen::Vector3d& p_W) const;
  /// Pixel at distance `depth_m` along the optical axis to a world point (m).
  Eigen::Vector3d Deproject(const cv::Point2d& px, double depth_m) const;
  /// Pixel to the world point (m) where its ray meets the plane z = height_m.
  Eigen::Vector3d OntoPlane(const cv::Point2d& px, double height_m) const;
};

/// The overhead camera of the scene: straight down from (0, 0, height_m), image right = world +x,
/// image up = world +y.
CameraModel OverheadCamera(const Pinhole& pinhole, double height_m);

}  // namespace gusset
