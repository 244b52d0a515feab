#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace gusset {

/// Triangles, counter-clockwise seen from outside, metres.
struct TriMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace gusset
