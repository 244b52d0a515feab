#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "tests/sim/cloth_bench.h"

namespace gusset {
namespace {

// A sheet on a table that slopes down along x: a level table under tilted gravity. Nothing but
// friction brakes it, for air acts along normals only.
class Slope {
 public:
  Slope(double mu, double tan_angle)
      : bench_(false, Sheet(mu), Undamped(), 0.5f * static_cast<float>(BagConfig{}.thickness_m)),
        begin_(bench_.cloth.state().x) {
    const auto angle = static_cast<float>(std::atan(tan_angle));
    bench_.cloth.gravity_m_s2 = kG * Vec3f(std::sin(angle), 0, -std::cos(angle));
  }
  void Run(double seconds) { bench_.Run(seconds); }
  /// Down the slope, mean over the nodes.
  double Speed() const {
    double sum = 0;
    for (const Vec3f& v : bench_.cloth.state().v) sum += v.x();
    return sum / static_cast<double>(begin_.size());
  }
  /// The furthest that any node has come, m.
  double Way() const {
    float most = 0;
    for (std::size_t i = 0; i < begin_.size(); ++i) {
      most = std::max(most, (bench_.cloth.state().x[i] - begin_[i]).norm());
    }
    return most;
  }

 private:
  static BagConfig Sheet(double mu) {
    BagConfig bag;
    bag.friction_table = mu;
    return bag;
  }
  static ClothSolverConfig Undamped() {
    ClothSolverConfig solver;
    solver.damping_per_s = 0;
    return solver;
  }
  Bench bench_;
  Vec3Array begin_;
};

class TableFriction : public testing::TestWithParam<double> {};

// Coulomb from below: at 0.95 mu nothing may creep. 0.1 mm in 60 s is 3 nm a substep at
// 600 a second; positions near 0.1 m are rounded to 7 nm.
TEST_P(TableFriction, HoldsASheetOnAGentlerSlopeForAMinute) {
  Slope slope(GetParam(), 0.95 * GetParam());
  slope.Run(60);
  RecordProperty("way_m", std::to_string(slope.Way()));
  EXPECT_LT(slope.Way(), 1e-4);
}

// And from above: a = g (sin - mu cos). At 1.05 mu, 5 % of that is a quarter of a percent of mu.
TEST_P(TableFriction, LetsASheetSlideDownASteeperSlopeAtCoulombsAcceleration) {
  for (const double steeper : {1.05, 1.5}) {
    Slope slope(GetParam(), steeper * GetParam());
    slope.Run(0.1);
    const double before = slope.Speed();
    slope.Run(0.5);
    const double measured = (slope.Speed() - before) / 0.5;
    const double angle = std::atan(steeper * GetParam());
    const double expected = kG * (std::sin(angle) - GetParam() * std::cos(angle));
    RecordProperty(steeper < 1.1 ? "ratio_at_1.05_mu" : "ratio_at_1.5_mu",
                   std::to_string(measured / expected));
    EXPECT_NEAR(measured, expected, 0.05 * expected) << "at " << steeper << " mu";
  }
}

INSTANTIATE_TEST_SUITE_P(Mu, TableFriction, testing::Values(0.2, 0.6, 0.8));

}  // namespace
}  // namespace gusset
