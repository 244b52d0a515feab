#pragma once

#include <cstddef>
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

/// Which of Statics' items the canvas is.
inline constexpr std::size_t kCanvasItem = 0;

/// Colour of the cube, the orange red of the published pictures, and how much darker its sides are.
inline const Eigen::Vector3f kCubeRgb{0.95f, 0.22f, 0.07f};
inline constexpr float kCubeContrast = 0.75f;

}  // namespace gusset
