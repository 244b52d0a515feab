#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "base/random.h"
#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/yarn_solver.h"

namespace gusset {
namespace {

constexpr float kRest_m = 0.02f;

ClothYarn Chain(int first, int count) {
  ClothYarn yarn;
  yarn.rest_m = kRest_m;
  for (int i = 0; i < count; ++i) yarn.nodes.push_back(first + i);
  return yarn;
}

// Nodes `distance_m` apart along x.
Vec4Array Straight(int count, float distance_m) {
  Vec4Array x;
  for (int i = 0; i < count; ++i) x.emplace_back(distance_m * static_cast<float>(i), 0, 0, 0);
  return x;
}

float Length(const Vec4Array& x, int link) { return (x[link + 1] - x[link]).norm(); }

// By 1 % too long, and a thousand times heavier at its end: one pass, where a sweep over the links
// leaves nearly all of that.
TEST(YarnSolver, ALoadedYarnIsAsLongAsAtRestAfterOnePass) {
  constexpr int kNodes = 18;
  std::vector<float> inv_mass(kNodes, 1e4f);
  inv_mass.front() = 0;
  inv_mass.back() = 10;
  YarnSolver solver({Chain(0, kNodes)}, inv_mass);
  const Vec4Array x_prev = Straight(kNodes, kRest_m);
  Vec4Array x = Straight(kNodes, 1.01f * kRest_m);
  solver.Solve(0, x_prev, x);
  EXPECT_EQ(x.front(), Vec4f::Zero());
  for (int i = 0; i + 1 < kNodes; ++i) EXPECT_NEAR(Length(x, i), kRest_m, 1e-6f) << i;
}

TEST(YarnSolver, KeepsTheCentreOfMass) {
  Rng rng(3);
  std::vector<float> inv_mass;
  Vec4Array x;
  for (int i = 0; i < 12; ++i) {
    inv_mass.push_back(static_cast<float>(rng.Uniform(5e3, 2e4)));
    x.emplace_back(0.022f * static_cast<float>(i), static_cast<float>(rng.Uniform(0, 0.01)),
                   static_cast<float>(rng.Uniform(0, 0.01)), 0);
  }
  const auto centre = [&] {
    Vec4f sum = Vec4f::Zero();
    float mass = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += x[i] / inv_mass[i];
      mass += 1 / inv_mass[i];
    }
    return Vec4f(sum / mass);
  };
  YarnSolver solver({Chain(0, 12)}, inv_mass);
  const Vec4Array before = x;
  const Vec4f was = centre();
  solver.Solve(0, Straight(12, kRest_m), x);
  EXPECT_GT((x[0] - before[0]).norm(), 1e-3f);
  EXPECT_LT((centre() - was).norm(), 1e-7f);
}

// Of a bent yarn with every link too long: by the matrix of all its links at once.
TEST(YarnSolver, MovesAsTheDenseSystemSays) {
  constexpr int kNodes = 9, kLinks = kNodes - 1;
  constexpr double kCompliance = 300;
  Rng rng(5);
  std::vector<float> inv_mass;
  Vec4Array x;
  for (int i = 0; i < kNodes; ++i) {
    inv_mass.push_back(static_cast<float>(rng.Uniform(5e3, 2e4)));
    const float t = static_cast<float>(i);
    x.emplace_back(0.03f * t, 0.01f * std::sin(t), 0.01f * std::cos(2 * t), 0);
  }
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(kLinks, 3 * kNodes);
  Eigen::VectorXd excess(kLinks), w(3 * kNodes);
  for (int i = 0; i < kNodes; ++i) w.segment<3>(3 * i).setConstant(inv_mass[i]);
  for (int j = 0; j < kLinks; ++j) {
    const Eigen::Vector3d way = (x[j + 1] - x[j]).head<3>().cast<double>();
    excess[j] = way.norm() - kRest_m;
    ASSERT_GT(excess[j], 1e-3);
    J.block<1, 3>(j, 3 * j) = -way.normalized().transpose();
    J.block<1, 3>(j, 3 * j + 3) = way.normalized().transpose();
  }
  const Eigen::MatrixXd system =
      J * w.asDiagonal() * J.transpose() + kCompliance * Eigen::MatrixXd::Identity(kLinks, kLinks);
  const Eigen::VectorXd tension = system.ldlt().solve(excess);
  ASSERT_GT(tension.minCoeff(), 0);
  const Eigen::VectorXd move = -(w.asDiagonal() * J.transpose() * tension);
  const Vec4Array before = x;
  YarnSolver solver({Chain(0, kNodes)}, inv_mass);
  solver.Solve(kCompliance, Straight(kNodes, kRest_m), x);
  for (int i = 0; i < kNodes; ++i) {
    const Eigen::Vector3d moved = (x[i] - before[i]).head<3>().cast<double>();
    EXPECT_LT((moved - move.segment<3>(3 * i)).norm(), 2e-6) << i;
  }
}

TEST(YarnSolver, PullsAndDoesNotPush) {
  YarnSolver solver({Chain(0, 6)}, std::vector<float>(6, 1e4f));
  const Vec4Array x_prev = Straight(6, kRest_m);
  Vec4Array slack = Straight(6, 0.9f * kRest_m);
  const Vec4Array before = slack;
  solver.Solve(0, x_prev, slack);
  EXPECT_EQ(slack, before);
  // The last link is too long, all others slack: what they are joined to does not feel it.
  slack[5].x() += 0.005f;
  solver.Solve(0, x_prev, slack);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(slack[i], before[i]) << i;
  EXPECT_NEAR(Length(slack, 4), kRest_m, 1e-7f);
  EXPECT_NEAR(slack[4].x() - before[4].x(), before[5].x() + 0.005f - slack[5].x(), 1e-7f);
}

// A link barely too long beside one far too long would have to push: it slackens instead, and the
// other moves as if it were alone.
TEST(YarnSolver, LinksThatWouldPushSlacken) {
  YarnSolver solver({Chain(0, 3)}, std::vector<float>(3, 1e4f));
  // Folded back on itself: what shortens the second link lengthens nothing of the first.
  Vec4Array x = {{0, 0, 0, 0}, {kRest_m + 1e-5f, 0, 0, 0}, {-0.01f, 0, 0, 0}};
  const Vec4Array before = x;
  solver.Solve(0, Straight(3, kRest_m), x);
  EXPECT_EQ(x[0], before[0]);
  EXPECT_NEAR(Length(x, 1), kRest_m, 1e-7f);
  EXPECT_NEAR(x[1].x() - before[1].x(), before[2].x() - x[2].x(), 1e-7f);
}

TEST(YarnSolver, RefusesAYarnWithoutALink) {
  EXPECT_THROW(YarnSolver({Chain(0, 1)}, {1e4f}), std::invalid_argument);
}

TEST(YarnSolver, UndoesOldExcessByHalves) {
  YarnSolver solver({Chain(0, 6)}, std::vector<float>(6, 1e4f));
  Vec4Array x = Straight(6, 1.1f * kRest_m);
  for (const float excess : {0.1f, 0.05f, 0.025f, 0.0125f}) {
    for (int i = 0; i < 5; ++i) EXPECT_NEAR(Length(x, i), (1 + excess) * kRest_m, 1e-6f) << i;
    const Vec4Array x_prev = x;
    solver.Solve(0, x_prev, x);
  }
}

// Eight yarns side by side, and what is left over: each as if it were alone.
TEST(YarnSolver, LanesDoNotMatter) {
  constexpr int kYarns = 11, kNodes = 7;
  Rng rng(7);
  std::vector<ClothYarn> yarns;
  std::vector<float> inv_mass;
  Vec4Array x_prev, x;
  for (int i = 0; i < kYarns * kNodes; ++i) {
    if (i % kNodes == 0) yarns.push_back(Chain(i, kNodes));
    inv_mass.push_back(static_cast<float>(rng.Uniform(5e3, 2e4)));
    const float along = kRest_m * static_cast<float>(i % kNodes);
    x_prev.emplace_back(along, static_cast<float>(i / kNodes), 0, 0);
    x.push_back(x_prev.back());
    for (int k = 0; k < 3; ++k) x.back()[k] += static_cast<float>(rng.Uniform(-0.003, 0.003));
  }
  Vec4Array together = x;
  YarnSolver(yarns, inv_mass).Solve(1, x_prev, together);
  Vec4Array one_by_one = x;
  for (const ClothYarn& yarn : yarns) YarnSolver({yarn}, inv_mass).Solve(1, x_prev, one_by_one);
  EXPECT_NE(together, x);
  EXPECT_EQ(together, one_by_one);
}

TEST(BagMesh, YarnsAreTheLinksAsChains) {
  BagConfig bag;
  bag.nodes_across = 9;
  bag.nodes_deep = 11;
  for (const ClothMesh& mesh : {MakeBagMesh(bag), MakeSheetMesh(bag)}) {
    std::multiset<std::array<int, 2>> links, chained;
    for (const ClothLink& link : mesh.stretch) {
      links.insert({std::min(link.a, link.b), std::max(link.a, link.b)});
    }
    for (const ClothYarn& yarn : mesh.yarns) {
      for (std::size_t k = 0; k + 1 < yarn.nodes.size(); ++k) {
        const int a = yarn.nodes[k], b = yarn.nodes[k + 1];
        chained.insert({std::min(a, b), std::max(a, b)});
        EXPECT_FLOAT_EQ((mesh.uv[a] - mesh.uv[b]).norm(), yarn.rest_m);
      }
    }
    EXPECT_EQ(chained, links);
    const auto of_length = [&](std::size_t nodes) {
      return std::ranges::count_if(mesh.yarns,
                                   [&](const ClothYarn& y) { return y.nodes.size() == nodes; });
    };
    // Those of the seams once: 11 + 10 wefts and 9 + 7 warps of a bag.
    EXPECT_EQ(of_length(9), mesh.layers == 2 ? 21 : 11);
    EXPECT_EQ(of_length(11), mesh.layers == 2 ? 16 : 9);
  }
}

}  // namespace
}  // namespace gusset
