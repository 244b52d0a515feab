#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace gusset {

/// Whether a triangle meets the box |x| <= half: separating axes (Akenine-Moeller 2001).
inline bool TriangleMeetsBox(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                             const Eigen::Vector3d& c, const Eigen::Vector3d& half) {
  const auto separates = [&](const Eigen::Vector3d& axis) {
    const double pa = axis.dot(a), pb = axis.dot(b), pc = axis.dot(c);
    const double reach = axis.cwiseAbs().dot(half);
    return std::min({pa, pb, pc}) > reach || std::max({pa, pb, pc}) < -reach;
  };
  const std::array<Eigen::Vector3d, 3> edges = {b - a, c - b, a - c};
  if (separates(edges[0].cross(edges[1]))) return false;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
    if (separates(axis)) return false;
    for (const Eigen::Vector3d& edge : edges) {
      if (separates(axis.cross(edge))) return false;
    }
  }
  return true;
}

}  // namespace gusset
