#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/simd.h"

namespace gusset {

/// Yarns in tension, each solved as a whole.
///
/// A sweep over links hands a load on from node to node and leaves yarns the longer the more hangs
/// from them. A yarn's links are a chain, though, so its tensions are a tridiagonal system, solved
/// directly (Goldenthal et al. 2007, "Efficient simulation of inextensible cloth", take all links
/// of a cloth at once; compliance as in one sweep of XPBD, Macklin et al. 2016). A yarn only pulls:
/// links that the solution pushes with are slack, and it is solved once more without them.
class YarnSolver {
 public:
  /// Eight yarns that share no node, of as many nodes each, side by side.
  struct Group {
    using Lanes = std::array<float, kLanes8>;
    std::size_t count = 0;  ///< Lanes past it hold the first yarn again.
    alignas(32) Lanes rest_m{};
    struct alignas(32) Place {
      Lanes inv_mass;
      std::array<std::uint16_t, kLanes8> node;
    };
    std::vector<Place> places;  ///< Along the yarns.
  };

  /// Throws std::invalid_argument if a yarn has no link.
  YarnSolver(std::vector<ClothYarn> yarns, std::vector<float> inv_mass);

  /// Groups of all yarns that pass one of these nodes (true: is one).
  std::vector<Group> GroupsAt(const std::vector<bool>& nodes) const;
  /// One pass over all yarns, or over those of some groups: links end as long as at rest,
  /// or by half as much longer as they were at x_prev, where the substep began.
  /// @param compliance  of a link, / h^2, 1/kg.
  void Solve(float compliance, const Vec4Array& x_prev, Vec4Array& x) {
    Solve(compliance, all_, x_prev, x);
  }
  void Solve(float compliance, const std::vector<Group>& groups, const Vec4Array& x_prev,
             Vec4Array& x);

 private:
  using Lanes = Group::Lanes;
  /// Of a node of eight yarns, and of the link from it to the next.
  struct alignas(32) Row {
    Lanes x, y, z;
    Lanes along_x, along_y, along_z;  ///< Unit vectors.
    Lanes excess;                     ///< How much longer the link is than it may be, m.
    Lanes coupling;                   ///< To the link before.
    Lanes pulls;                      ///< Truth values.
    Lanes upper, right;               ///< The row of the system once those before are eliminated.
    Lanes tension;                    ///< Times h^2, kg m.
  };

  std::vector<Group> Pack(const std::vector<int>& yarns) const;
  void Solve(float compliance, const Group& group, const Vec4Array& x_prev, Vec4Array& x);
  bool Measure(const Group& group, const Vec4Array& x_prev, const Vec4Array& x);
  void FindTensions(float compliance, const Group& group);
  bool SlackenPushing(std::size_t links);
  void Move(const Group& group, Vec4Array& x) const;

  std::vector<ClothYarn> yarns_;
  std::vector<float> inv_mass_;
  std::vector<Group> all_;
  std::vector<Row> rows_;  ///< Scratch.
};

}  // namespace gusset
