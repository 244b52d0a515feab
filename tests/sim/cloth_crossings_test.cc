#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "sim/cloth/self_contact.h"

namespace gusset {
namespace {

// Every edge against every face that it has no node in common with, solved for the point where the
// edge's line meets the face's plane.
int CrossingsOneByOne(const ClothMesh& mesh, const Vec3Array& x) {
  int crossings = 0;
  for (const auto& e : mesh.edges) {
    for (const auto& t : mesh.triangles) {
      if (std::count(t.begin(), t.end(), e[0]) + std::count(t.begin(), t.end(), e[1]) > 0) continue;
      const auto at = [&](int node) { return Eigen::Vector3d(x[node].cast<double>()); };
      Eigen::Matrix3d m;
      m << at(e[0]) - at(e[1]), at(t[1]) - at(t[0]), at(t[2]) - at(t[0]);
      if (m.determinant() == 0) continue;
      const Eigen::Vector3d s = m.inverse() * (at(e[0]) - at(t[0]));
      const bool on_edge = s[0] > 0 && s[0] < 1;
      crossings += on_edge && s[1] > 0 && s[2] > 0 && s[1] + s[2] < 1;
    }
  }
  return crossings;
}

TEST(CountCrossings, OfAJumbledBagAreThoseCountedOneByOne) {
  const ClothMesh mesh = MakeBagMesh({});
  Rng rng(1);
  for (const double jumbled_m : {0.002, 0.02, 0.1}) {
    Vec3Array x = mesh.rest;
    for (Vec3f& p : x) {
      for (int k = 0; k < 3; ++k) p[k] += static_cast<float>(rng.Uniform(-jumbled_m, jumbled_m));
    }
    const int expected = CrossingsOneByOne(mesh, x);
    EXPECT_GT(expected, 100) << jumbled_m;
    EXPECT_EQ(CountCrossings(mesh, x), expected) << jumbled_m;
  }
}

TEST(CountCrossings, OfABagLaidFlatAreNoneUntilANodeOfOneLayerIsBelowTheOther) {
  const ClothMesh mesh = MakeBagMesh({});
  Vec3Array x = mesh.rest;
  EXPECT_EQ(CountCrossings(mesh, x), 0);
  const auto highest = [&](int a, int b) { return x[a].z() < x[b].z(); };
  // Any node of the upper layer, sunk by three thicknesses.
  std::vector<int> nodes(x.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = static_cast<int>(i);
  x[*std::max_element(nodes.begin(), nodes.end(), highest)].z() -= 3 * mesh.thickness_m;
  EXPECT_GE(CountCrossings(mesh, x), 3);
}

}  // namespace
}  // namespace gusset
