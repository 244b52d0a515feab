#include "sim/cloth/rigid_shape.h"

#include <cmath>

namespace gusset {

float SignedDistance(const RigidShape& shape, const Vec3f& p_S, Vec3f& normal_S) {
  if (shape.kind == RigidShape::Kind::kSphere) {
    const float r = p_S.norm();
    normal_S = r > 1e-9f ? Vec3f(p_S / r) : Vec3f(Vec3f::UnitZ());
    return r - shape.half.x();
  }
  if (shape.kind == RigidShape::Kind::kCylinder) {
    const float rho = std::hypot(p_S.x(), p_S.y());
    const Vec3f radial = rho > 1e-9f ? Vec3f(p_S.x() / rho, p_S.y() / rho, 0) : Vec3f(1, 0, 0);
    const Vec3f axial(0, 0, p_S.z() < 0 ? -1.0f : 1.0f);
    const float dr = rho - shape.half.x(), dz = std::abs(p_S.z()) - shape.half.z();
    if (dr > 0 && dz > 0) {
      const float d = std::hypot(dr, dz);
      normal_S = (radial * dr + axial * dz) / d;
      return d;
    }
    normal_S = dr > dz ? radial : axial;
    return std::max(dr, dz);
  }
  const Vec3f excess = p_S.cwiseAbs() - shape.half;
  const Vec3f sign(p_S.x() < 0 ? -1.0f : 1.0f, p_S.y() < 0 ? -1.0f : 1.0f,
                   p_S.z() < 0 ? -1.0f : 1.0f);
  if ((excess.array() > 0).any()) {
    const Vec3f outside = excess.cwiseMax(0.0f);
    const float d = outside.norm();
    normal_S = outside.cwiseProduct(sign) / d;
    return d;
  }
  int axis;
  const float d = excess.maxCoeff(&axis);
  normal_S = Vec3f::Zero();
  normal_S[axis] = sign[axis];
  return d;
}

}  // namespace gusset
