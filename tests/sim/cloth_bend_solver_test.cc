#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "sim/cloth/bend_solver.h"

namespace gusset {
namespace {

constexpr float kH = 1 / 600.0f, kSpacing_m = 0.02f;

// A row of nodes, 1 g apiece, and its bends.
struct Row {
  Row(int count, float stiffness_N_m) : inv_mass(count, 1e3f) {
    for (int i = 0; i + 2 < count; ++i) bends.push_back({i, i + 1, i + 2, stiffness_N_m, 0});
    x.assign(count, Vec4f::Zero());
    v = x;
    for (int i = 0; i < count; ++i) x[i].x() = kSpacing_m * static_cast<float>(i);
    set.assign(bends.size(), 0.0f);
  }
  // What a row of unlike nodes may look like.
  void Crumple() {
    Rng rng(3);
    for (std::size_t i = 0; i < x.size(); ++i) {
      inv_mass[i] = 1e3f * static_cast<float>(rng.Uniform(0.5, 2));
      for (int k = 0; k < 3; ++k) x[i][k] += 0.01f * static_cast<float>(rng.Uniform(-1, 1));
      for (int k = 0; k < 3; ++k) v[i][k] = static_cast<float>(rng.Uniform(-1, 1));
    }
  }
  double Energy_J() const {
    double sum = 0;
    for (std::size_t i = 0; i < v.size(); ++i) sum += 0.5 * v[i].squaredNorm() / inv_mass[i];
    for (const ClothBend& b : bends) {
      sum += 0.5 * b.stiffness_N_m * (x[b.a] - 2 * x[b.mid] + x[b.c]).squaredNorm();
    }
    return sum;
  }
  std::vector<ClothBend> bends;
  std::vector<float> inv_mass, set;
  Vec4Array x, v;
};

// The stiffness at which the shortest waves, w^2 = 16 k / m, are just stable: (w h)^2 = 4.
constexpr float kStable_N_m = 1e-3f / (4 * kH * kH);

TEST(BendSolver, WhereBendingIsSlowEachBendPullsByItself) {
  Row row(11, 0.4f * kStable_N_m);
  row.Crumple();
  constexpr float kDamping_s = 1e-4f;
  BendSolver solver(row.bends, row.inv_mass, kH, kDamping_s);
  ASSERT_EQ(solver.scaling_s2(), 0);
  Vec4Array expected = row.v;
  for (const ClothBend& b : row.bends) {
    const auto at = [&](int i) { return Vec4f(row.x[i] + kDamping_s * row.v[i]); };
    const Vec4f f = b.stiffness_N_m * (at(b.a) - 2 * at(b.mid) + at(b.c));
    expected[b.a] -= kH * row.inv_mass[b.a] * f;
    expected[b.mid] += 2 * kH * row.inv_mass[b.mid] * f;
    expected[b.c] -= kH * row.inv_mass[b.c] * f;
  }
  solver.Apply(kH, row.x, row.set, row.v);
  for (std::size_t i = 0; i < row.v.size(); ++i) {
    EXPECT_LT((row.v[i] - expected[i]).norm(), 1e-5f * expected[i].norm() + 1e-6f) << i;
  }
}

TEST(BendSolver, WhereItIsFastItKeepsMomentumAndAngularMomentum) {
  Row row(11, 50 * kStable_N_m);
  row.Crumple();
  BendSolver solver(row.bends, row.inv_mass, kH, 0);
  EXPECT_GT(solver.scaling_s2(), 0);
  const Vec4Array before = row.v;
  solver.Apply(kH, row.x, row.set, row.v);
  Eigen::Vector3d gained = Eigen::Vector3d::Zero(), turned = gained;
  double pushes = 0, torques = 0;
  for (std::size_t i = 0; i < row.v.size(); ++i) {
    const Eigen::Vector3d x = row.x[i].head<3>().cast<double>();
    const Eigen::Vector3d impulse =
        (row.v[i] - before[i]).head<3>().cast<double>() / row.inv_mass[i];
    gained += impulse;
    turned += x.cross(impulse);
    pushes += impulse.norm();
    torques += x.cross(impulse).norm();
  }
  ASSERT_GT(pushes, 0);
  EXPECT_LT(gained.norm(), 1e-5 * pushes);
  EXPECT_LT(turned.norm(), 1e-5 * torques);
}

// Explicitly, a zigzag at 50 times what is stable grows a hundredfold in every substep.
TEST(BendSolver, StiffRowsNeitherGainNorLoseEnergyForLong) {
  for (const float times : {0.9f, 1.5f, 50.0f, 1000.0f}) {
    Row row(11, times * kStable_N_m);
    for (std::size_t i = 0; i < row.x.size(); ++i) row.x[i].z() = i % 2 == 0 ? 1e-4f : -1e-4f;
    BendSolver solver(row.bends, row.inv_mass, kH, 0);
    const double start = row.Energy_J();
    double most = 0, late = 0;
    for (int step = 0; step < 6000; ++step) {
      solver.Apply(kH, row.x, row.set, row.v);
      for (std::size_t i = 0; i < row.x.size(); ++i) row.x[i] += kH * row.v[i];
      most = std::max(most, row.Energy_J());
      if (step >= 5900) late = std::max(late, row.Energy_J());
    }
    // A substep's velocities are half a substep older than its positions.
    EXPECT_LT(most, 60 * start) << times;
    EXPECT_GT(late, 0.2 * start) << times << ": nothing damps it";
  }
}

// A long wave of a stiff row is as fast as in the continuum, w^2 = (k / m) (2 sin(q / 2))^4.
TEST(BendSolver, LongWavesStayAsFastAsTheyAre) {
  constexpr int kNodes = 65;
  Row row(kNodes, 20 * kStable_N_m);
  BendSolver solver(row.bends, row.inv_mass, kH, 0);
  // Two whole waves of a free row's inner nodes would feel its ends; one look at what they gain
  // in the middle does not.
  const float q = 2 * static_cast<float>(M_PI) / 32;
  for (int i = 0; i < kNodes; ++i) row.x[i].z() = 1e-3f * std::cos(q * (i - kNodes / 2));
  solver.Apply(kH, row.x, row.set, row.v);
  const double rate2 = -row.v[kNodes / 2].z() / kH / row.x[kNodes / 2].z();
  const double expected = 20 * kStable_N_m / 1e-3 * std::pow(2 * std::sin(q / 2), 4);
  EXPECT_NEAR(rate2 / expected, 1 / (1 + solver.scaling_s2() * expected), 1e-3);
  EXPECT_GT(rate2 / expected, 0.99);
}

TEST(BendSolver, RefusesRings) {
  std::vector<ClothBend> ring;
  for (int i = 0; i < 6; ++i) ring.push_back({i, (i + 1) % 6, (i + 2) % 6, 1, 0});
  EXPECT_THROW(BendSolver(ring, std::vector<float>(6, 1.0f), kH, 0), std::invalid_argument);
}

}  // namespace
}  // namespace gusset
