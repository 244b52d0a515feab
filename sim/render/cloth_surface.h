#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/render/scene_view.h"

namespace gusset {

/// A cloth as cameras see it: the triangles that are simulated, shaded as if smooth. Plain
/// geometry, no OpenGL. What is seen is a shell, one side half a thickness along the normals, one
/// against them. A node in a seam has a vertex, and so a normal, in each of its layers.
///
/// Smooth surfaces through the nodes (the modified butterfly scheme; Zorin, Schroeder, Sweldens
/// 1996) would look hardly different and pass through each other where layers lie upon each other:
/// contact keeps flat triangles apart (docs/camera.md).
class ClothSurface {
 public:
  /// @throws InputError if the cloth's arrays do not fit together.
  explicit ClothSurface(const ClothItem& cloth);
  /// True if `cloth` has the same triangles, layers and coordinates as the one given.
  bool Fits(const ClothItem& cloth) const;
  /// Positions and normals for the cloth's present shape. @throws InputError for NaN or infinity.
  void Update(const ClothItem& cloth);

  const std::vector<Eigen::Vector3f>& positions() const { return positions_; }
  /// Unit length (or zero where a patch has collapsed); along the triangles' winding.
  const std::vector<Eigen::Vector3f>& normals() const { return normals_; }
  /// How far either side lies from the positions, m. Above 0, even if the cloth has no thickness.
  float half_thickness_m() const { return half_thickness_m_; }
  /// Cloth coordinates (m) and layer of each vertex.
  const std::vector<Eigen::Vector3f>& uv_layer() const { return uv_layer_; }
  const std::vector<std::array<unsigned, 3>>& triangles() const { return triangles_; }

 private:
  std::vector<std::array<int, 3>> source_triangles_;
  std::vector<std::uint8_t> source_layers_;
  std::vector<Eigen::Vector2f> source_uv_;
  std::vector<int> node_of_;  // of each vertex
  std::vector<std::array<unsigned, 3>> triangles_;
  std::vector<Eigen::Vector3f> uv_layer_, positions_, normals_;
  float half_thickness_m_ = 0;
};

}  // namespace gusset
