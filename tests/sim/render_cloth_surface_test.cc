#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

#include "sim/render/cloth_surface.h"
#include "tests/sim/render_bag.h"

namespace gusset {
namespace {

// Contact keeps simulated triangles apart, and no others: what is drawn must be those.
TEST(ClothSurface, IsTheSimulatedCloth) {
  const ClothItem bag = CrumpledBag();
  ClothSurface surface(bag);
  surface.Update(bag);
  ASSERT_EQ(surface.triangles().size(), bag.triangles.size());
  for (std::size_t t = 0; t < bag.triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const unsigned vertex = surface.triangles()[t][k];
      const int node = bag.triangles[t][k];
      EXPECT_EQ(surface.positions()[vertex], bag.x[node]);
      EXPECT_EQ(surface.uv_layer()[vertex].head<2>(), bag.uv[node]);
      EXPECT_EQ(surface.uv_layer()[vertex].z(), bag.triangle_layer[t]);
    }
  }
}

TEST(ClothSurface, ShadesFlatClothFlat) {
  ClothItem bag = FlatBag();
  const Eigen::Vector3f slope(0.3f, -0.2f, 0);
  for (Eigen::Vector3f& p : bag.x) p.z() = 0.2f + slope.dot(p);
  ClothSurface surface(bag);
  surface.Update(bag);
  const Eigen::Vector3f normal = Eigen::Vector3f(-0.3f, 0.2f, 1).normalized();
  for (const Eigen::Vector3f& n : surface.normals()) EXPECT_GT(n.dot(normal), 0.9999f);
}

TEST(ClothSurface, ShadesARollAsRound) {
  // Of 30 mm radius: triangles 20 mm long are up to 20 degrees off, normals 8 at most (the
  // triangles' diagonals all run the same way).
  constexpr float kRadius = 0.03f;
  ClothItem bag = FlatBag();
  for (Eigen::Vector3f& p : bag.x) {
    const float angle = p.y() / kRadius;
    p.y() = kRadius * std::sin(angle);
    p.z() = 0.1f + kRadius * std::cos(angle);
  }
  ClothSurface surface(bag);
  surface.Update(bag);
  const float rows_m = 0.35f / 17;
  for (std::size_t v = 0; v < surface.positions().size(); ++v) {
    const Eigen::Vector3f& uv = surface.uv_layer()[v];
    if (uv.y() < rows_m / 2 || uv.y() > 0.35f - rows_m / 2) continue;
    const Eigen::Vector3f& p = surface.positions()[v];
    const Eigen::Vector3f outward = Eigen::Vector3f(0, p.y(), p.z() - 0.1f).normalized();
    EXPECT_GT(surface.normals()[v].dot(outward), std::cos(8 * 3.14159f / 180)) << "vertex " << v;
  }
}

TEST(ClothSurface, LayersMeetAtTheSeams) {
  const ClothItem bag = CrumpledBag();
  ClothSurface surface(bag);
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
    EXPECT_EQ(entry->second, surface.positions()[v]);
  }
  EXPECT_EQ(met, 17 + 15 + 17 + 1);  // three seams' edges
}

TEST(ClothSurface, FitsOnlyTheSameMesh) {
  ClothItem bag = FlatBag();
  const ClothSurface surface(bag);
  bag.x[0].z() += 1;
  EXPECT_TRUE(surface.Fits(bag));
  bag.triangle_layer[0] = 1;
  EXPECT_FALSE(surface.Fits(bag));
}

}  // namespace
}  // namespace gusset
