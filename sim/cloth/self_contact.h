#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/cloth_types.h"
#include "sim/cloth/motion_forecast.h"
#include "sim/cloth/pair_memory.h"
#include "sim/cloth/pair_search.h"

namespace gusset {

/// Contact of a cloth with itself: node against triangle and edge against edge, one thickness
/// apart, with Coulomb friction, and the guarantee that nothing passes through anything.
///
/// A substep starts from a configuration without crossings, so the vector between a pair's closest
/// points tells its sides; no memory of sides is needed. A plane perpendicular to that vector
/// bounds the pair's motion: while all nodes of one element stay on one side of it and all of the
/// other on the other, the elements cannot have crossed. What Gauss-Seidel cannot separate moves as
/// one rigid zone (Bridson et al. 2002, section 7.4), which keeps the start's distances and so
/// always succeeds.
///
/// Two forecasts of the nodes' motion save work. A far one says for which pairs the search has to
/// look, a near one which of them need a plane now; both are checked in every substep, and a node
/// that does not keep to its forecast makes for a new one (the displacement bounds of Chen et al.
/// 2025, "Offset Geometric Contact", made to follow the motion).
class SelfContact {
 public:
  SelfContact(const ClothMesh& mesh, float friction);

  /// Forgets all pairs; the next substep searches anew.
  void Invalidate();
  /// Start of a substep of h seconds at x, where Enforce left it unless Invalidate was called
  /// since, with velocities v so far.
  void Prepare(const Vec4Array& x, const Vec4Array& v, float h, float separation_m);
  /// One Gauss-Seidel pass: pushes pairs apart to one thickness and applies friction.
  void Solve(const Vec4Array& x_prev, const std::vector<float>& inv_mass, Vec4Array& x);
  /// After the substep, with the velocities v that came of it: notes how much contacts slipped, and
  /// where layers were pushed apart because they were closer than a thickness, takes the speed of
  /// that from them, or a lump of cloth would never come to rest.
  void EndSubstep(const std::vector<float>& inv_mass, float h, Vec4Array& v);
  /// Last word of a substep: after it, no pair has crossed between x_prev and x.
  /// @param floor_m lowest height a node's centre may have.
  void Enforce(const Vec4Array& x_prev, const std::vector<float>& inv_mass, float h, float floor_m,
               Vec4Array& x);

  int pair_count() const { return static_cast<int>(node_triangle_.size() + edge_edge_.size()); }
  /// Contacts that carry force where they touch, not those that are only watched.
  int force_count() const { return static_cast<int>(force_count_); }
  long selections() const { return selections_; }

 private:
  /// One cache line.
  struct alignas(64) Contact {
    Vec4f normal = Vec4f::Zero();      ///< From the second element to the first.
    std::array<float, 4> weight = {};  ///< Of each node in the gap vector; signed.
    std::array<std::uint16_t, 4> node = {};
    float gap_m = 0;   ///< Along the normal between the weighted points, at the substep's start;
                       ///< kept up to date for contacts that carry force.
    float kept_m = 0;  ///< What the contact keeps its elements apart; 0: watched for crossing only.
    float goal_m = 0;  ///< What kept_m slowly goes to, by how cloth lay when selected.
    float target_m = 0;  ///< As much of kept_m as may be gained in this substep.
    std::array<std::uint16_t, 2> element = {};  ///< As ElementPair's.
    bool edges = false;
    std::uint64_t pair() const {
      return std::uint64_t{edges} << 32 | std::uint64_t{element[0]} << 16 | element[1];
    }
  };
  /// What is looked at in every substep, of eight contacts, side by side: a third of their bytes.
  struct alignas(32) Planes {
    using Lanes = std::array<float, kLanes8>;
    Lanes nx, ny, nz;          ///< Normals.
    Lanes w1, w2, w3;          ///< Weights of nodes 1 to 3.
    Lanes edges;               ///< 1: edge against edge, 0: node against triangle.
    Lanes gap, clear;          ///< At the substep's start: as Contact::gap_m, and between the
                               ///< elements' extreme nodes.
    Lanes end_gap, end_clear;  ///< The same where FindViolated last looked.
    Lanes placed;              ///< Gap when the plane was last placed.
    Lanes accepted;            ///< Clearance that the substep's end must leave.
    std::array<std::array<std::uint16_t, kLanes8>, 4> node;  ///< [corner][lane]
  };

  void ForgetForecasts();
  void Search(const Vec4Array& x, const Vec4Array& v);
  void Select(const Vec4Array& x, const Vec4Array& v);
  template <bool edges>
  void SelectFrom(const Sieve<ElementPair>& pairs, const Vec4Array& x);
  void SearchAlong(const Vec4Array& x_prev, const Vec4Array& x, float h, bool far);
  void Place(const std::array<Contact*, kLanes8>& contacts, const Vec4Array& x) const;
  void Measure(const Vec4Array& x);
  bool IsClosest(const Contact& c, const Vec4Array& x) const;
  void KeepByRidges(const Vec4Array& x);
  float Clearance(const Contact& c, const Vec4Array& x, int& first, int& second) const;
  float LeastClearance(float clear_m) const;
  float clear_m(std::size_t contact) const {
    return planes_[contact / kLanes8].clear[contact % kLanes8];
  }
  void SetPlane(std::size_t contact);
  bool FindViolated(const Vec4Array& x);
  bool PushApart(const std::vector<float>& inv_mass, Vec4Array& x);
  void MoveAsZones(const Vec4Array& x_prev, const std::vector<float>& inv_mass, float floor_m,
                   Vec4Array& x);

  const ClothMesh& mesh_;
  float thickness_m_;
  float friction_;
  float returned_ = 0;  ///< Share of the slip remembered that this substep takes back.
  PairSearch pair_search_;
  MotionForecast far_, near_;
  std::array<float, 2> errors_ = {};              ///< Of far_ and near_.
  bool errors_known_ = false;                     ///< For x as it is.
  Sieve<ElementPair> node_triangle_, edge_edge_;  ///< What may meet within far_.
  std::vector<Contact> contacts_;  ///< What may meet within near_; first those that carry force.
  std::size_t force_count_ = 0;
  PairMemory kept_;  ///< What contacts that carried force kept before the last selection.
  std::vector<std::uint64_t> pushed_;  ///< Bit i: contact i pushed in this substep.
  Vec4Array slipped_;  ///< How far each contact that carries force has slipped, as remembered.
  std::vector<float> most_slipped_m_;  ///< What friction could take back of that.
  std::vector<Planes> planes_;         ///< Of all contacts, in their order; the last ones repeated.
  // Scratch.
  Vec4Array v_;
  /// A node's displacement since the search, now, then at the near forecast's end, whose margin
  /// rides along.
  struct alignas(32) Moves {
    std::array<float, kLanes8> now_end;
  };
  std::vector<Moves> moves_;
  Sieve<int> near_pairs_;
  std::vector<Contact> guards_, picked_;
  std::vector<Contact*> asked_;  ///< Of picked_: those whose force depends on the bend.
  std::vector<float> approach_m_;
  std::vector<int> violated_;
  long selections_ = 0;
};

/// Edges that pierce a face; zero for a cloth that never passed through itself.
/// For tests and health checks.
int CountCrossings(const ClothMesh& mesh, const Vec3Array& x);

}  // namespace gusset
