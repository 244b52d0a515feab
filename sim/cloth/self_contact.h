#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/cloth_types.h"

namespace gusset {

/// Contact of a cloth with itself: node against triangle and edge against edge, one thickness apart,
/// with Coulomb friction, and the guarantee that nothing passes through anything.
///
/// A substep starts from a configuration without crossings, so the vector between a pair's closest
/// points tells its sides; no memory of sides is needed. Each pair's separating plane, perpendicular
/// to that vector, bounds the substep's motion: while all nodes of one element stay on one side and
/// all of the other on the other, the elements cannot have crossed (the planes of Planar-DAT; the
/// per-node bounds of Chen et al. 2025, "Offset Geometric Contact", serve the pair search). What
/// Gauss-Seidel cannot separate moves as one rigid zone (Bridson et al. 2002, section 7.4), which
/// keeps the start's distances and so always succeeds.
class SelfContact {
 public:
  SelfContact(const ClothMesh& mesh, float friction);

  /// Finds afresh every pair that can come into contact before some node has moved further than its
  /// margin, which follows its speed.
  void Detect(const Vec3Array& x, const Vec3Array& v);
  /// Forgets all pairs; the next substep searches anew.
  void Invalidate() { valid_ = false; }
  /// True if a node has used up most of its margin at x.
  bool Stale(const Vec3Array& x) const;

  /// Start of a substep from x_prev; x is where the nodes would go without contact.
  void Prepare(const Vec3Array& x_prev, const Vec3Array& x, float separation_m);
  /// One Gauss-Seidel pass: pushes pairs apart to one thickness and applies friction.
  void Solve(const Vec3Array& x_prev, const std::vector<float>& inv_mass, Vec3Array& x);
  /// Last word of a substep: after it, no pair has crossed between x_prev and x.
  /// @param floor_m lowest height a node's centre may have.
  void Enforce(const Vec3Array& x_prev, const std::vector<float>& inv_mass, float floor_m,
               Vec3Array& x);

  int pair_count() const { return static_cast<int>(pairs_.size()); }
  int near_count() const { return static_cast<int>(force_count_); }
  long detections() const { return detections_; }
  long zones() const { return zones_; }

 private:
  struct Pair {
    std::array<std::uint16_t, 4> node;
    float distance_m;  ///< When detected.
    bool edges;        ///< Edge (0,1) against edge (2,3); else node 0 against triangle (1,2,3).
    bool guard;        ///< Another pair carries the contact force; watched for crossing only.
    std::uint16_t triangle;
  };
  struct Contact {
    std::array<int, 4> node;
    std::array<float, 4> weight;  ///< Of each node in the gap vector; signed.
    Vec3f normal;                 ///< From the second element to the first.
    Vec3f origin;                 ///< Closest point on the second element, at the substep's start.
    float distance_m;
    float target_m;
    bool edges;
    bool guard;
  };
  /// Axis-aligned box; a fourth, unused lane makes it two vector loads.
  struct Box {
    Eigen::Array4f lo = Eigen::Array4f::Zero(), hi = Eigen::Array4f::Zero();
    bool Overlaps(const Box& o) const { return (lo <= o.hi).all() && (o.lo <= hi).all(); }
    void Set(const Vec3f& low, const Vec3f& high, float grow);
  };
  struct TreeNode {
    int left = -1, right = -1, patch = -1;
    Box box;
  };

  int BuildTree(int row0, int row1, int col0, int col1);
  void Refit(const Vec3Array& x);
  void SelfPairs(int node, const Vec3Array& x);
  void CrossPairs(int a, int b, const Vec3Array& x);  // x: where they were detected
  void PatchPairs(const ClothPatch& a, const ClothPatch& b, const Vec3Array& x);
  void AddNodeTriangle(int node, int triangle, const Vec3Array& x);
  void AddEdgeEdge(int e, int f, const Vec3Array& x);
  bool Owns(int triangle, const Vec3f& barycentric) const;
  Contact MakeContact(const Pair& pair, const Vec3Array& x_prev, float separation_m) const;
  float Clearance(const Contact& c, const Vec3Array& x, int& first, int& second) const;
  bool CannotCross(const Contact& c) const;
  void UpdateMoves(const Vec3Array& x);
  float LeastDistance(const Pair& pair) const;

  const ClothMesh& mesh_;
  float thickness_m_;
  float friction_;
  std::vector<ClothPatch> patches_;
  int columns_ = 0;
  std::vector<TreeNode> tree_;  // children before parents
  std::vector<int> roots_;      // one per layer
  std::vector<std::array<int, 4>> corner_;  // nodes of each patch
  // A point on a triangle's border is closest for all triangles that share the border; the one that
  // owns the corner or edge carries the force. Bit k: corner k; bit 3 + k: edge from corner k on.
  std::vector<std::uint8_t> owned_;

  bool valid_ = false;
  Vec3Array detected_x_;
  std::vector<Box> edge_box_, triangle_box_, node_box_;
  std::vector<float> margin_m_;
  std::vector<float> move_m_;  // since detection, relative to the mean motion
  std::vector<float> step_m_;  // within the substep, relative to the mean motion
  std::vector<Pair> pairs_;
  std::vector<Contact> contacts_;  // the first force_count_ carry force, the others guard
  std::size_t force_count_ = 0;
  std::vector<char> has_contact_;
  long detections_ = 0;
  long zones_ = 0;
};

/// Edges that pierce a face; zero for a cloth that never passed through itself. O(n^2) over
/// overlapping boxes; for tests and health checks.
int CountCrossings(const ClothMesh& mesh, const Vec3Array& x);

}  // namespace gusset
