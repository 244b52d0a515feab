#pragma once

#include <array>
#include <vector>

#include "sim/tri_mesh.h"

namespace gusset {

/// A mesh with one normal per vertex, ready for the graphics card.
struct ShadedMesh {
  struct Vertex {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;
  };
  std::vector<Vertex> vertices;
  std::vector<std::array<unsigned, 3>> triangles;
};

/// Normals averaged over the faces round a vertex, weighted by area, that lie within `crease_deg`
/// of the face at hand: round parts look round, edges stay sharp. Vertices at the same place count
/// as one; triangles without area are dropped.
ShadedMesh WithNormals(const TriMesh& mesh, double crease_deg);

}  // namespace gusset
