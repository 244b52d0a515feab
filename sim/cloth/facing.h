#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/simd.h"

namespace gusset {

/// Which of the elements that are close to a point of the cloth carry its contact force.
///
/// A corner or a side of a triangle is the closest part of the cloth only for what lies in its
/// normal cone; elsewhere the cloth goes on towards it and another element is closer (the feature
/// sets of Chen et al. 2025, "Offset Geometric Contact", section 3). A force from outside the cone
/// would lean against sliding. An edge along which the cloth is flat has a cone without width:
/// there nodes against triangles carry the force. Between a flat edge and a ridge the share of the
/// thickness that edges keep rises with the bend, since contacts that appear at once would shake a
/// lump forever.
class Facing {
 public:
  explicit Facing(const ClothMesh& mesh);

  /// True if `triangle` is the one that carries a contact at this point of it: a point on a border
  /// is closest for all triangles that share the border, and only one may push.
  bool Owns(int triangle, const std::array<float, 3>& barycentric) const;
  /// False where the cloth beyond the border point of `triangle` goes on towards `outwards`, a unit
  /// vector from that point to the node. True inside.
  bool IsClosest(int triangle, const std::array<float, 3>& barycentric, const Vec4f& outwards,
                 const Vec4Array& x) const;
  /// Eight edges, a unit vector across each, and what FindRidgeShares answers.
  struct alignas(32) EdgeQuery {
    using Lanes = std::array<float, kLanes8>;
    Lanes outwards_x, outwards_y, outwards_z;
    Lanes share;
    std::array<std::uint16_t, kLanes8> edge;
  };
  /// The share of a thickness, 0 to 1, that each edge keeps from what lies along its vector: 0 up
  /// to a fifth of ridge_sine() inside the edge's normal cone, 1 from ridge_sine() on.
  void FindRidgeShares(const Vec4Array& x, EdgeQuery& query) const;
  /// Per edge: 1 if some direction lies in its cone far enough for it to keep anything, or one
  /// triangle alone has it. Edges that are flat now stay so until the next search.
  void FindRidges(const Vec4Array& x, std::vector<std::uint8_t>& ridge) const;

  /// Sine of how far inside an edge's cone something must be for the edge to keep a whole
  /// thickness.
  float ridge_sine() const { return ridge_sine_; }

 private:
  const ClothMesh& mesh_;
  float ridge_sine_;
  /// Per triangle. Bit k: owns corner k; bit 3 + k: the side from corner k on.
  std::vector<std::uint8_t> owned_;
  std::vector<std::array<int, 2>> across_edge_;  ///< Per edge: third nodes of its triangles, or -1.
  std::vector<std::array<int, 3>> across_side_;  ///< Per triangle and side: the neighbour's, or -1.
  std::vector<std::vector<int>> around_;         ///< Per node: the other ends of its edges.
};

}  // namespace gusset
