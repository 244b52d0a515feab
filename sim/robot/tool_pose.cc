#include "sim/robot/tool_pose.h"

#include <cmath>

namespace gusset {

Eigen::Isometry3d TiltRadially(const Eigen::Isometry3d& X_WT, const Eigen::Vector3d& p_WB,
                               double tilt_rad) {
  Eigen::Vector3d outward = X_WT.translation() - p_WB;
  outward.z() = 0;
  if (outward.norm() < 1e-9) return X_WT;  // above the base no direction is radial
  // About outward x up, a positive turn takes "down" to "outward".
  const Eigen::Vector3d axis = outward.normalized().cross(Eigen::Vector3d::UnitZ());
  Eigen::Isometry3d X = X_WT;
  X.linear() = Eigen::AngleAxisd(tilt_rad, axis).toRotationMatrix() * X_WT.linear();
  return X;
}

Eigen::Isometry3d DownwardPose(const Eigen::Vector3d& p_W, double yaw_rad) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = p_W;
  X.linear().col(0) = Eigen::Vector3d(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  X.linear().col(2) = -Eigen::Vector3d::UnitZ();
  X.linear().col(1) = X.linear().col(2).cross(X.linear().col(0));
  return X;
}

Eigen::Isometry3d Flipped(const Eigen::Isometry3d& X_WT) {
  Eigen::Isometry3d X = X_WT;
  X.linear().leftCols<2>() *= -1;
  return X;
}

}  // namespace gusset
