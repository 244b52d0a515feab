#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/simd.h"

namespace gusset {

/// Distance constraints by Gauss-Seidel, four links that share no node at a
/// time.
///
/// Links keep their order as far as that allows, so a sweep carries a load
/// along a row of yarn as far as link-by-link sweeping does. What shares no node
/// may be reordered without changing a bit.
class LinkSolver {
 public:
  /// Throws std::invalid_argument if there are fewer nodes than four lanes need: eight always do.
  LinkSolver(const std::vector<ClothLink>& links, const std::vector<float>& inv_mass);

  /// Internal friction: a spring beside the compliant one, which slips (Prandtl's element).
  struct Friction {
    float stiffness = 0;     ///< Times h^2, kg. 0: none.
    float slip_m = 0;        ///< Elongation at which it slips.
    bool both_ways = false;  ///< In links longer than at rest too.
  };
  struct Sweep {
    float tension;      ///< Compliance / h^2 of a link longer than at rest, 1/kg.
    float compression;  ///< The same of a shorter one.
    bool forward;       ///< In order of the links, or against it.
    bool push;          ///< False: shorter links are left alone.
    Friction friction;
  };
  /// @param set per lane: elongation (m) that friction holds to; updated where the sweep pushes.
  void Solve(const Sweep& sweep, std::vector<float>& set, Vec4Array& x) const;
  std::size_t lane_count() const { return lane_count_; }

 private:
  struct Packet {
    std::array<std::uint16_t, 4> a, b;
    Float4 rest, inv_mass_a, inv_mass_b;
    std::array<int, 4> lane;  ///< Index into a sweep's `set`.
  };
  struct Compliances;
  void Solve(const Packet& p, const Compliances& with, float* set, Vec4Array& x) const;

  std::vector<Packet> packets_;
  std::size_t lane_count_ = 0;
};

}  // namespace gusset
