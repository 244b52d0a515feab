#pragma once

#include <vector>

#include "sim/render/scene_view.h"

namespace gusset {

/// A box with the given edge lengths (m), centred on its frame's origin.
TriMesh BoxMesh(const Eigen::Vector3d& size_m);

/// What never moves, in world coordinates: black canvas, white table, floor, the arm's pedestal.
/// Owns its meshes; items() point into them.
class Statics {
 public:
  Statics();
  Statics(const Statics&) = delete;
  Statics& operator=(const Statics&) = delete;
  const std::vector<RenderItem>& items() const { return items_; }

 private:
  std::vector<TriMesh> meshes_;
  std::vector<RenderItem> items_;
};

/// Colour of the cube: the slightly orange red of the published pictures.
inline const Eigen::Vector3f kCubeRgb{0.86f, 0.17f, 0.09f};

}  // namespace gusset
