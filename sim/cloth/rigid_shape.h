#pragma once

#include <Eigen/Geometry>
#include <cmath>

#include "sim/cloth/cloth_types.h"

namespace gusset {

/// A convex rigid body as the cloth sees it. Kinematic when inv_mass is 0.
struct RigidShape {
  enum class Kind { kBox, kSphere, kCylinder };  ///< Cylinder: axis along z.
  Kind kind = Kind::kBox;
  Vec3f half =
      Vec3f::Zero();  ///< Box: half extents. Sphere: (r, r, r). Cylinder: (r, r, half length).
  Eigen::Isometry3f X_WS = Eigen::Isometry3f::Identity();       ///< At the substep's end.
  Eigen::Isometry3f X_WS_prev = Eigen::Isometry3f::Identity();  ///< At its start.
  float friction = 0.5f;
  float inv_mass = 0;  ///< 1/kg.
  Eigen::Matrix3f inv_inertia_W = Eigen::Matrix3f::Zero();
  /// What the cloth did to the body in this substep, momentum in N s and N m s about its centre.
  Vec3f impulse = Vec3f::Zero();
  Vec3f angular_impulse = Vec3f::Zero();
  /// Kinematic bodies: force (N) of cloth squeezed against what is not the gripper, which yields no
  /// further.
  Vec3f squeeze = Vec3f::Zero();
  /// Force on the body's -x face, whatever the cloth is squeezed against; a gripper's pads read it.
  float squeeze_minus_x = 0;
};

/// What a unit impulse along `direction` at `arm` from the centre changes the speed there by, 1/kg.
inline float InvMassAt(const RigidShape& shape, const Vec3f& arm, const Vec3f& direction) {
  if (shape.inv_mass == 0) return 0;
  const Vec3f turned = arm.cross(direction);
  return shape.inv_mass + turned.dot(shape.inv_inertia_W * turned);
}

/// True only if SignedDistance is at least `gap_m` (positive): a cheap look before it.
inline bool ClearlyOff(const RigidShape& shape, const Vec3f& p_S, float gap_m) {
  if (shape.kind == RigidShape::Kind::kBox) {
    return std::abs(p_S.x()) - shape.half.x() >= gap_m ||
           std::abs(p_S.y()) - shape.half.y() >= gap_m ||
           std::abs(p_S.z()) - shape.half.z() >= gap_m;
  }
  if (shape.kind == RigidShape::Kind::kSphere) return false;
  const float off = 1.001f * (shape.half.x() + gap_m);  // more than rounding takes
  return std::abs(p_S.z()) - shape.half.z() >= gap_m ||
         p_S.x() * p_S.x() + p_S.y() * p_S.y() >= off * off;
}

/// Distance (m, negative inside) of p_S from the shape's surface and the outward normal there.
float SignedDistance(const RigidShape& shape, const Vec3f& p_S, Vec3f& normal_S);

}  // namespace gusset
