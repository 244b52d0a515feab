#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/facing.h"
#include "sim/cloth/motion_forecast.h"
#include "sim/cloth/sieve.h"

namespace gusset {

/// A pair that carries no force is watched for crossing when closer than this
/// share of a thickness.
constexpr float kGuardedShare = 0.2f;

/// Two elements of a cloth that may meet: node 0 against triangle (1, 2, 3), or
/// edge (0, 1) against edge (2, 3). 20 bytes.
struct ElementPair {
  std::array<std::uint16_t, 4> node;
  float distance_m;                      ///< When found.
  std::array<std::uint16_t, 2> element;  ///< Node and triangle, or both edges.
  bool edges;
  bool guard;  ///< Another pair carries the contact force; watched for crossing
               ///< only.
};

/// Finds every pair of elements that can come closer than one thickness (kGuardedShare of it where
/// borders or flat edges meet, which carry no force) while a forecast of their motion holds: a tree
/// of boxes over the mesh's quads, boxes swept along the forecast, then the distance of each
/// remaining pair against how far the two can move towards each other.
class PairSearch {
 public:
  explicit PairSearch(const ClothMesh& mesh);

  /// Node-triangle pairs and edge-edge pairs, in an order that depends on the
  /// mesh alone.
  void Find(const MotionForecast& forecast, Sieve<ElementPair>& node_triangle,
            Sieve<ElementPair>& edge_edge);

  const Facing& facing() const { return facing_; }

 private:
  /// Its low corner, then its high one negated: one register, and one comparison tells whether two
  /// boxes touch.
  struct alignas(32) Box {
    std::array<float, kLanes8> corners;
  };
  struct TreeNode {
    int left = -1, right = -1, patch = -1;
  };
  /// A patch's elements and place, laid out for speed.
  struct PatchElements {
    std::uint16_t layer, row, column;  ///< Rows of all layers in one count.
    std::uint16_t node_count, edge_count;
    std::array<std::uint16_t, 4> node;
    std::array<std::uint16_t, 5> edge;
    std::array<std::uint16_t, 2> triangle;
    bool sewn;  ///< Has nodes that are another layer's too.
  };
  using IdPair = std::array<std::uint16_t, 2>;

  int BuildTree(int row0, int row1, int col0, int col1);
  void ListNeighbours();
  void Refit(const MotionForecast& forecast);
  void Self(int node);
  void Cross(int a, int b);
  void CrossOverlapping(int a, int b);
  template <bool may_share>
  void Patches(const PatchElements& p, const PatchElements& q);
  bool AreNeighbours(int a, int b) const;
  bool Share(int node, int triangle) const;
  bool ShareEnd(int edge, int other) const;
  void MeasureNodeTriangle(const MotionForecast& forecast, Sieve<ElementPair>& out) const;
  void MeasureEdgeEdge(const MotionForecast& forecast, Sieve<ElementPair>& out) const;

  const ClothMesh& mesh_;
  std::vector<ClothPatch> patches_;      ///< [layer][row][column].
  std::vector<PatchElements> elements_;  ///< Of each patch.
  int rows_ = 0, columns_ = 0;
  std::vector<TreeNode> tree_;  ///< Children before parents.
  std::vector<int> roots_;      ///< One per layer.
  /// Elements of adjoining patches of one layer that share no node; their boxes
  /// nearly always touch, so the tree leaves them to these lists.
  std::vector<IdPair> near_node_triangle_, near_edges_;
  Facing facing_;
  std::vector<std::uint8_t> ridge_;  ///< Per edge: may carry force, as Facing::FindRidges has it.

  std::vector<Box> node_box_, edge_box_, triangle_box_, tree_box_;
  Sieve<IdPair> maybe_node_triangle_, maybe_edges_;  ///< Boxes touch.
};

}  // namespace gusset
