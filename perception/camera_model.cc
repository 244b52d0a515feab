#include "perception/camera_model.h"

namespace gusset {

cv::Point2d CameraModel::Project(const Eigen::Vector3d& p_W) const {
  const Eigen::Vector3d p_C = X_WC.inverse() * p_W;
  return {pinhole.fx * p_C.x() / p_C.z() + pinhole.cx, pinhole.fy * p_C.y() / p_C.z() + pinhole.cy};
}

Eigen::Vector3d CameraModel::Deproject(const cv::Point2d& px, double depth_m) const {
  return X_WC * Eigen::Vector3d((px.x - pinhole.cx) / pinhole.fx * depth_m,
                                (px.y - pinhole.cy) / pinhole.fy * depth_m, depth_m);
}

Eigen::Vector3d CameraModel::OntoPlane(const cv::Point2d& px, double height_m) const {
  const Eigen::Vector3d origin = X_WC.translation();
  const Eigen::Vector3d ray = Deproject(px, 1.0) - origin;
  return origin + ray * ((height_m - origin.z()) / ray.z());
}

CameraModel OverheadCamera(const Pinhole& pinhole, double height_m) {
  CameraModel camera;
  camera.pinhole = pinhole;
  camera.X_WC.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  camera.X_WC.translation() << 0, 0, height_m;
  return camera;
}

}  // namespace gusset
