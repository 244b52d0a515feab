#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <ostream>
#include <string>

#include "tests/sim/cloth_bench.h"

namespace gusset {
namespace {

// As in sim/cloth/bend_solver.cc and sim/cloth/cloth.cc.
constexpr double kFrictionSpring = 4, kLinkSlip_m = 5e-4;
// Lifts the bag by a fifth of a millimetre.
constexpr double kBound_J = 1e-4;

// Kinetic energy, and what weight, bends, shear, buckles and the springs of internal friction
// store. Yarns in tension store less than 1e-6 J at the bag's weight and are left out. A substep's
// velocity is that of its middle, so positions are those of the middle too.
class Ledger {
 public:
  Ledger(const Cloth& cloth, const BagConfig& bag, const ClothSolverConfig& solver)
      : cloth_(cloth),
        solver_(solver),
        stretch_set_(cloth.mesh().stretch.size(), 0.0),
        shear_set_(cloth.mesh().shear.size(), 0.0),
        buckling_N_m_(2 * bag.flexural_rigidity_Nm * bag.residual_curvature_1_m / kLinkSlip_m),
        shearing_N_m_(bag.shear_hysteresis_N_m * bag.opening_m / (bag.nodes_across - 1) /
                      kLinkSlip_m) {}

  double Energy_J() {
    const ClothMesh& mesh = cloth_.mesh();
    const ClothState& state = cloth_.state();
    double sum = 0;
    std::vector<Eigen::Vector3d> x;
    const double half_h = 0.5 / solver_.substeps_per_s;
    for (std::size_t i = 0; i < state.x.size(); ++i) {
      x.push_back(state.x[i].cast<double>() - half_h * state.v[i].cast<double>());
      sum += mesh.mass_kg[i] * (0.5 * state.v[i].squaredNorm() + kG * x[i].z());
    }
    for (std::size_t i = 0; i < mesh.bends.size(); ++i) {
      const ClothBend& b = mesh.bends[i];
      const double bent = (x[b.a] - 2 * x[b.mid] + x[b.c]).norm();
      const double rubs = bent - state.bend_set[i];
      sum += 0.5 * b.stiffness_N_m * (bent * bent + kFrictionSpring * rubs * rubs);
    }
    const double buckled = solver_.compression_compliance_m_N;
    const double sheared = solver_.shear_compliance_m_N;
    const auto length = [&](const ClothLink& link) { return (x[link.b] - x[link.a]).norm(); };
    for (std::size_t i = 0; i < mesh.stretch.size(); ++i) {
      const double c = length(mesh.stretch[i]) - mesh.stretch[i].rest_m;
      const double rubs = Slip(stretch_set_[i], c);
      if (c < 0) sum += 0.5 * (c * c / buckled + buckling_N_m_ * rubs * rubs);
    }
    for (std::size_t i = 0; i < mesh.shear.size(); ++i) {
      const double c = length(mesh.shear[i]) - mesh.shear[i].rest_m;
      const double rubs = Slip(shear_set_[i], c);
      const double compliance = c < 0 ? std::max(buckled, sheared) : sheared;
      sum += 0.5 * (c * c / compliance + shearing_N_m_ * rubs * rubs);
    }
    return sum;
  }

 private:
  /// What a link's friction spring is strained by, after it has slipped as far as it must.
  static double Slip(double& set, double c) {
    set = std::min(std::max(set, c - kLinkSlip_m), c + kLinkSlip_m);
    return c - set;
  }

  const Cloth& cloth_;
  const ClothSolverConfig solver_;
  std::vector<double> stretch_set_, shear_set_;
  const double buckling_N_m_, shearing_N_m_;
};

struct Rise {
  double over_start_J = -1;   ///< The most by which energy exceeded that at the start.
  double over_lowest_J = 0;   ///< And what it had been at its lowest till then.
  double over_seconds_J = 0;  ///< A second's mean over that of any second before.
};

// Nobody touches the bag for 10 s.
Rise Watch(Bench& bench, const BagConfig& bag, const ClothSolverConfig& solver) {
  // Friction of the links begins where the ledger does: it holds to no elongation.
  ClothState state = bench.cloth.state();
  state.stretch_set.clear();
  state.shear_set.clear();
  bench.cloth.SetState(state);
  Ledger ledger(bench.cloth, bag, solver);
  const double start = ledger.Energy_J();
  double lowest = start, lowest_second = start;
  Rise rise;
  for (int second = 0; second < 10; ++second) {
    double mean = 0;
    for (int i = 0; i < solver.substeps_per_s; ++i) {
      bench.Run(bench.h);
      const double energy = ledger.Energy_J();
      mean += energy / solver.substeps_per_s;
      rise.over_start_J = std::max(rise.over_start_J, energy - start);
      rise.over_lowest_J = std::max(rise.over_lowest_J, energy - lowest);
      lowest = std::min(lowest, energy);
    }
    rise.over_seconds_J = std::max(rise.over_seconds_J, mean - lowest_second);
    lowest_second = std::min(lowest_second, mean);
  }
  testing::Test::RecordProperty("over_start_J", std::to_string(1e6 * rise.over_start_J) + "e-6");
  testing::Test::RecordProperty("over_lowest_J", std::to_string(1e6 * rise.over_lowest_J) + "e-6");
  testing::Test::RecordProperty("over_seconds_J",
                                std::to_string(1e6 * rise.over_seconds_J) + "e-6");
  return rise;
}

class Energy : public testing::Test {
 protected:
  // By a point off the middle, so that it hangs askew.
  void Lift(float height_m) {
    bench_.Run(0.3);
    bench_.GrabAt({0.05f, 0.05f, 0});
    bench_.Run(height_m / 0.4, Vec3f(0, 0, 0.4f));
  }
  BagConfig bag_;
  ClothSolverConfig solver_;
  Bench bench_{true, bag_, solver_};
};

// From one substep to another the ledger rises by up to 3.1e-4 J over its lowest so far, 1.0e-4 J
// without internal friction, 0.5e-4 J with ten sweeps besides: it sees links at a substep's end,
// not where friction acted on them, and yarns that are left longer give back what they
// took. So single substeps are compared with the start and seconds among themselves.
TEST_F(Energy, OfASwingingBagDoesNotGrow) {
  Lift(0.6f);
  bench_.Run(0.4, Vec3f(0.5f, 0, 0));
  const Rise rise = Watch(bench_, bag_, solver_);
  EXPECT_LT(rise.over_start_J, kBound_J);
  EXPECT_LT(rise.over_seconds_J, kBound_J);
}

TEST_F(Energy, OfAFallingBagNeverGrowsNotEvenWhenItLands) {
  Lift(0.6f);
  bench_.cloth.EndHold();
  EXPECT_LT(Watch(bench_, bag_, solver_).over_lowest_J, kBound_J);
}

TEST_F(Energy, OfACrumpledBagNeverGrows) {
  Lift(0.25f);
  bench_.cloth.EndHold();
  bench_.Run(2);
  EXPECT_LT(Watch(bench_, bag_, solver_).over_lowest_J, kBound_J);
}

constexpr float kRest_m_s = 0.003f;  // WorldConfig::rest_speed_m_s

// The most within 10 s, looked at 20 times a second.
float MostRmsSpeed(Bench& bench) {
  float most = 0;
  for (int i = 0; i < 200; ++i) {
    bench.Run(0.05);
    most = std::max(most, bench.cloth.RmsSpeed());
  }
  testing::Test::RecordProperty("rms_mm_s", std::to_string(1e3f * most));
  return most;
}

struct Place {
  float x, y;
};

void PrintTo(const Place& p, std::ostream* os) { *os << p.x << ", " << p.y << " m"; }

class RestAfterADrop : public testing::TestWithParam<Place> {};

// Wherever it was held and let go from 0.25 m.
TEST_P(RestAfterADrop, Lasts) {
  Bench bench(true);
  bench.Run(0.3);
  bench.GrabAt({GetParam().x, GetParam().y, 0});
  ASSERT_TRUE(bench.cloth.holding());
  bench.Run(1.0, Vec3f(0, 0, 0.25f));
  bench.cloth.EndHold();
  bench.Run(5);
  EXPECT_LT(MostRmsSpeed(bench), kRest_m_s);
}

INSTANTIATE_TEST_SUITE_P(HeldAt, RestAfterADrop,
                         testing::Values(Place{0.05f, 0.05f}, Place{-0.10f, 0.12f},
                                         Place{0.0f, -0.15f}));

// The swing and what it shakes decay within 20 s.
TEST(Rest, OfAHangingBagLasts) {
  Bench bench(true);
  bench.Run(0.3);
  bench.GrabAt({0.05f, 0.05f, 0});
  bench.Run(1.5, Vec3f(0, 0, 0.4f));
  bench.Run(20);
  EXPECT_TRUE(bench.cloth.holding());
  EXPECT_LT(MostRmsSpeed(bench), kRest_m_s);
}

}  // namespace
}  // namespace gusset
