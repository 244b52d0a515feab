#include <gtest/gtest.h>

#include <cmath>

#include "sim/cloth/cloth.h"
#include "sim/cloth/link_solver.h"

namespace gusset {
namespace {

// Mean curvature (1/m) of a cloth's rows across.
double Curvature(const Cloth& cloth, const BagConfig& bag) {
  const double spacing = bag.opening_m / (bag.nodes_across - 1);
  double sum = 0;
  int count = 0;
  for (const ClothBend& b : cloth.mesh().bends) {
    if (b.c - b.mid != b.mid - b.a || b.mid - b.a != 1) continue;
    const Vec3Array& x = cloth.state().x;
    sum += (x[b.a] - 2 * x[b.mid] + x[b.c]).norm() / (spacing * spacing);
    ++count;
  }
  return sum / count;
}

// The curvature that a sheet, rolled up to 25 1/m in free space, keeps when it is let go.
double Kept(double residual_curvature_1_m) {
  BagConfig bag;
  bag.opening_m = bag.depth_m = 0.10;
  bag.nodes_across = bag.nodes_deep = 8;
  bag.residual_curvature_1_m = residual_curvature_1_m;
  bag.shear_hysteresis_N_m = 0;
  ClothSolverConfig solver;
  solver.substeps_per_s = 4000;
  solver.damping_per_s = 60;
  Cloth cloth(MakeSheetMesh(bag), bag, solver);
  cloth.gravity_m_s2.setZero();
  ClothState state = cloth.state();
  constexpr float kRadius = 1 / 25.0f;
  for (Vec3f& p : state.x) {
    const float angle = p.x() / kRadius;
    p = Vec3f(kRadius * std::sin(angle), p.y(), 0.5f + kRadius * (1 - std::cos(angle)));
  }
  // It was flat before: friction holds to that as far as it can.
  state.bend_set.assign(cloth.mesh().bends.size(), 0.0f);
  cloth.SetState(state);
  EXPECT_NEAR(Curvature(cloth, bag), 25, 0.5);
  const float h = 1.0f / static_cast<float>(solver.substeps_per_s);
  for (int i = 0; i < 2 * solver.substeps_per_s; ++i) {
    cloth.Predict(h);
    std::vector<RigidShape> none;
    cloth.SolveConstraints(h, Eigen::Isometry3f::Identity(), none);
  }
  return Curvature(cloth, bag);
}

// The elastic moment B kappa falls until friction, B kappa_r, holds it.
TEST(InternalFriction, ARolledSheetKeepsTheResidualCurvature) {
  EXPECT_LT(Kept(0), 0.5);
  const double five = Kept(5), ten = Kept(10);
  // Free ends keep less than the middle, and Dahl's taper near flat takes some.
  EXPECT_LT(ten, 10.5);
  EXPECT_GT(ten, 6);
  EXPECT_LT(five, 5.5);
  EXPECT_GT(ten, 1.5 * five);
}

// Two nodes, one link of 20 mm, pressed to 17 mm and let go for a second.
double LengthAfterPress(double friction_N) {
  constexpr float kMass_kg = 1e-4f, kH = 1 / 600.0f, kSlip_m = 5e-4f, kCompliance_m_N = 1;
  // Lanes without a link of their own work on nodes that no other lane has: three here.
  const std::vector<float> inv_mass(5, 1 / kMass_kg);
  const LinkSolver links({{0, 1, 0.020f}}, inv_mass);
  std::vector<float> set(links.lane_count(), 0.0f);
  Vec4Array x(5, Vec4f::Zero()), v(5, Vec4f::Zero());
  x[1].x() = 0.017f;
  const LinkSolver::Friction friction{static_cast<float>(friction_N) / kSlip_m * kH * kH, kSlip_m,
                                      false};
  const LinkSolver::Sweep sweep{0, kCompliance_m_N / (kH * kH), true, true, friction};
  for (int i = 0; i < 600; ++i) {
    Vec4Array before = x;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] += v[k] * kH;
    links.Solve(sweep, set, x);
    for (std::size_t k = 0; k < x.size(); ++k) v[k] = (x[k] - before[k]) * (0.99f / kH);
  }
  return (x[1] - x[0]).norm();
}

TEST(InternalFriction, ABuckledLinkStaysShortIfFrictionIsTheStronger) {
  // The spring pushes with 3 mm / 1 m/N = 3 mN.
  EXPECT_NEAR(LengthAfterPress(0), 0.020, 2e-4);
  EXPECT_LT(LengthAfterPress(0.008), 0.0178) << "it springs back by the slip at most";
  EXPECT_GT(LengthAfterPress(0.001), 0.0185) << "weaker friction gives way";
}

TEST(LinkSolver, RefusesFewerNodesThanItsLanesNeed) {
  const std::vector<ClothLink> one = {{0, 1, 0.020f}};
  EXPECT_NO_THROW(LinkSolver(one, std::vector<float>(5, 1.0f)));
  EXPECT_THROW(LinkSolver(one, std::vector<float>(4, 1.0f)), std::invalid_argument);
}

}  // namespace
}  // namespace gusset
