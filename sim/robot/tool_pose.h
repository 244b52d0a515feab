#pragma once

#include <Eigen/Geometry>

namespace gusset {

/// Turns a tool pose about its own origin in the vertical plane through a base axis and that
/// origin.
/// @param p_WB  a point of the base's vertical axis.
/// @param tilt_rad  > 0: fingertips lean away from the base; < 0: towards it.
Eigen::Isometry3d TiltRadially(const Eigen::Isometry3d& X_WT, const Eigen::Vector3d& p_WB,
                               double tilt_rad);

/// Tool at p_W (m) pointing straight down; the fingers close along the world's x axis turned by
/// yaw_rad about z.
Eigen::Isometry3d DownwardPose(const Eigen::Vector3d& p_W, double yaw_rad);

/// The same grasp with the fingers exchanged: turned by half a turn about the approach axis.
Eigen::Isometry3d Flipped(const Eigen::Isometry3d& X_WT);

}  // namespace gusset
