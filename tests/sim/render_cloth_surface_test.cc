#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "sim/render/cloth_surface.h"
#include "tests/sim/render_bag.h"

namespace gusset {
namespace {

TEST(ClothSurface, KeepsEveryNodeWhereItIs) {
  const ClothItem bag = CrumpledBag();
  ClothSurface surface(bag, 1);
  surface.Update(bag);
  std::set<std::tuple<float, float, float>> drawn;
  for (const Eigen::Vector3f& p : surface.positions()) drawn.insert({p.x(), p.y(), p.z()});
  for (const Eigen::Vector3f& x : bag.x) EXPECT_TRUE(drawn.contains({x.x(), x.y(), x.z()}));
}

TEST(ClothSurface, KeepsFlatClothFlat) {
  ClothItem bag = FlatBag();
  const Eigen::Vector3f slope(0.3f, -0.2f, 0);
  for (Eigen::Vector3f& p : bag.x) p.z() = 0.2f + slope.dot(p);
  ClothSurface surface(bag, 2);
  surface.Update(bag);
  const Eigen::Vector3f normal = Eigen::Vector3f(-0.3f, 0.2f, 1).normalized();
  for (std::size_t v = 0; v < surface.positions().size(); ++v) {
    const Eigen::Vector3f& p = surface.positions()[v];
    EXPECT_NEAR(p.z(), 0.2f + slope.dot(p), 1e-6);  // single precision of 0.2 m
    EXPECT_GT(surface.normals()[v].dot(normal), 0.9999f);
  }
}

// What is printed on flat cloth must not be drawn elsewhere, nor larger: wherever the surface has
// its vertices, their coordinates are those of the cloth there.
TEST(ClothSurface, ShowsFlatClothWhereItIs) {
  const ClothItem bag = FlatBag();
  ClothSurface surface(bag, 2);
  surface.Update(bag);
  const Eigen::Vector2f shift = bag.x[0].head<2>() - bag.uv[0];
  for (std::size_t v = 0; v < surface.positions().size(); ++v) {
    const Eigen::Vector2f expected = surface.uv_layer()[v].head<2>() + shift;
    EXPECT_LT((surface.positions()[v].head<2>() - expected).norm(), 1e-6f);
  }
}

TEST(ClothSurface, FollowsARollBetweenNodes) {
  // A roll of 30 mm radius: chords of 20 mm nodes miss it by 20^2 / (8 * 30) = 1.7 mm.
  constexpr float kRadius = 0.03f;
  ClothItem bag = FlatBag();
  for (std::size_t n = 0; n < bag.x.size(); ++n) {
    const float angle = bag.x[n].y() / kRadius;
    bag.x[n].y() = kRadius * std::sin(angle);
    bag.x[n].z() = 0.1f + kRadius * std::cos(angle);
  }
  ClothSurface surface(bag, 1);
  surface.Update(bag);
  const float rows_m = 0.35f / 17;
  for (std::size_t v = 0; v < surface.positions().size(); ++v) {
    const Eigen::Vector3f& uv = surface.uv_layer()[v];
    if (uv.y() < 2 * rows_m || uv.y() > 0.35f - 2 * rows_m) continue;
    const Eigen::Vector3f& p = surface.positions()[v];
    EXPECT_NEAR(std::hypot(p.y(), p.z() - 0.1f), kRadius, 5e-4);
  }
}

TEST(ClothSurface, LayersMeetAtTheSeams) {
  const ClothItem bag = CrumpledBag();
  ClothSurface surface(bag, 2);
  surface.Update(bag);
  Eigen::Vector2f extent(0, 0);
  for (const Eigen::Vector2f& uv : bag.uv) extent = extent.cwiseMax(uv);
  std::map<std::pair<float, float>, Eigen::Vector3f> seam;  // by cloth coordinates
  int met = 0;
  for (std::size_t v = 0; v < surface.positions().size(); ++v) {
    const Eigen::Vector3f& uv = surface.uv_layer()[v];
    if (uv.x() != 0 && uv.x() != extent.x() && uv.y() != extent.y()) continue;
    const auto [entry, is_new] = seam.try_emplace({uv.x(), uv.y()}, surface.positions()[v]);
    if (is_new) continue;
    ++met;
    EXPECT_LT((entry->second - surface.positions()[v]).norm(), 1e-6);
  }
  // Two levels make four edges of one: three seams of 17, 15 and 17 edges.
  EXPECT_EQ(met, 4 * (17 + 15 + 17) + 1);
}

TEST(ClothSurface, DoesNotDipIntoTheTableBesideAWrinkle) {
  ClothItem bag = FlatBag();
  for (std::size_t n = 0; n < bag.x.size(); ++n) {
    if (std::abs(bag.x[n].y()) < 0.012f) bag.x[n].z() += 0.03f;
  }
  ClothSurface surface(bag, 2);
  surface.Update(bag);
  for (const Eigen::Vector3f& p : surface.positions()) {
    EXPECT_GE(p.z(), bag.thickness_m / 2 - 1e-7f);
  }
}

TEST(ClothSurface, FitsOnlyTheSameMesh) {
  ClothItem bag = FlatBag();
  const ClothSurface surface(bag, 1);
  bag.x[0].z() += 1;
  EXPECT_TRUE(surface.Fits(bag));
  bag.triangle_layer[0] = 1;
  EXPECT_FALSE(surface.Fits(bag));
}

}  // namespace
}  // namespace gusset
