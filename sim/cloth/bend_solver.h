#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/simd.h"

namespace gusset {

/// Bending of rows of the weave, with internal friction, as forces.
///
/// Three nodes in a row store k/2 |a - 2 mid + c|^2, damped in proportion. Beside it yarns rub on
/// yarns: a spring on the second difference's length that slips at a limit (Prandtl's element;
/// Miguel et al. 2013 fit cloth with Dahl's, which is the same with a rounded corner).
///
/// Of stiff cloth on a fine mesh the shortest waves are too fast for a substep. They are made
/// heavier, and only they, by as much as keeps them stable: what bending does to a row of masses M
/// and stiffness K is found with M + s K in place of M (selective mass scaling: Olovsson,
/// Simonsson, Unosson 2005, IJNME 63, section 3; a linearly implicit step: Eberhardt, Etzmuss,
/// Hauth 2000), which changes neither momentum nor angular momentum. A row's K is constant and has
/// five diagonals, so it is factored once. Where all waves are slow enough s is 0: explicit
/// bending.
class BendSolver {
 public:
  /// Throws std::invalid_argument if bends form a ring, or two begin with the same two nodes.
  /// @param h_s        of a substep.
  /// @param damping_s  of the elastic part.
  BendSolver(const std::vector<ClothBend>& bends, const std::vector<float>& inv_mass, float h_s,
             float damping_s);

  /// Changes velocities by what bending does in h seconds.
  /// @param set  per bend: the second difference (m) that friction holds to; slips along.
  void Apply(float h, const Vec4Array& x, std::vector<float>& set, Vec4Array& v);

  /// s above, in s^2: what bears a load in bending lags behind by s times the acceleration that
  /// the load would give it.
  float scaling_s2() const { return scaling_s2_; }

 private:
  using Lanes = std::array<float, kLanes8>;
  /// A node of eight rows that share none, and the bend that begins there.
  struct alignas(32) Place {
    std::array<std::uint16_t, kLanes8> node;
    std::array<std::uint16_t, kLanes8> bend;
    Lanes stiffness, most;              ///< N/m; m of strain before friction slips.
    Lanes inv_rows;                     ///< One over the rows that share the node's mass.
    Lanes inv_pivot, lower_1, lower_2;  ///< Of M + s K: D^-1, L next to the diagonal.
  };
  struct Group {
    std::size_t count = 0;  ///< Lanes past it hold the first row again.
    std::vector<Place> places;
  };
  struct Row {
    std::vector<int> nodes, bends;
  };

  static std::vector<Row> FindRows(const std::vector<ClothBend>& bends);
  void Factor(const std::vector<ClothBend>& bends, const Row& row,
              const std::vector<float>& share_kg, std::size_t lane,
              std::vector<Place>& places) const;
  void Apply(float h, const Group& group, const Vec4Array& x, std::vector<float>& set,
             Vec4Array& v);

  float damping_s_;
  float scaling_s2_ = 0;
  std::vector<Group> groups_;
  // Scratch.
  Vec4Array ahead_;
  struct alignas(32) Solved {
    Lanes x, y, z;
  };
  std::vector<Solved> solved_;
};

}  // namespace gusset
