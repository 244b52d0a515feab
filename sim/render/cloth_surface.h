#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/render/scene_view.h"

namespace gusset {

/// How often the surface that cameras see is refined: by the renderer, and where ground truth says
/// what it shows.
inline constexpr int kDrawnLevels = 1;

/// A smooth surface through a cloth's nodes: the cloth as cameras see it. Plain geometry, no
/// OpenGL. What is seen is a shell, one side half a thickness along the normals, one against them.
///
/// Each layer is refined by the modified butterfly scheme (Zorin, Schroeder, Sweldens 1996), which
/// keeps every node where it is, keeps flat cloth flat and is linear, so that the stencils are
/// worked out once per mesh. Layers are refined apart from each other: a seam is a border of both
/// and, as borders follow their own four-point rule, both layers still meet there.
class ClothSurface {
 public:
  /// Works out the stencils. `levels` times, every triangle becomes four.
  /// @throws InputError if the cloth's arrays do not fit together.
  ClothSurface(const ClothItem& cloth, int levels);
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
  /// A vertex in the middle of an edge: a weighted sum of vertices made before it.
  struct Midpoint {
    int a, b;                            // the edge's ends
    std::uint32_t taps_begin, taps_end;  // into taps_
  };
  struct Tap {
    int vertex;
    float weight;
  };
  void Refine();

  std::vector<std::array<int, 3>> source_triangles_;
  std::vector<std::uint8_t> source_layers_;
  std::vector<Eigen::Vector2f> source_uv_;
  std::vector<int> node_of_;         // of each of the first vertices, one per node and layer
  std::vector<Midpoint> midpoints_;  // of the vertices after those
  std::vector<Tap> taps_;
  std::vector<std::array<unsigned, 3>> triangles_;
  std::vector<Eigen::Vector3f> uv_layer_, positions_, normals_;
  float half_thickness_m_ = 0;
};

}  // namespace gusset
