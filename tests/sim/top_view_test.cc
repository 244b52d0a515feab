#include "sim/top_view.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gusset {
namespace {

// Every node on the plane z = 0.1 x - 0.2 y + h: there is one answer wherever there is cloth.
TEST(ClothTop, IsThePlaneThatTheClothLiesIn) {
  const BagConfig bag;
  const ClothMesh mesh = MakeBagMesh(bag);
  Vec3Array x;
  for (const Eigen::Vector3f& p : mesh.rest) {
    x.emplace_back(p.x(), p.y(), 0.1f * p.x() - 0.2f * p.y() + 0.05f);
  }
  for (const auto& [u, v] : {std::pair{0.2, 0.3}, {0.5, 0.5}, {0.71, 0.13}}) {
    const Eigen::Vector2d p(u * bag.opening_m, v * bag.depth_m);
    EXPECT_NEAR(ClothTopAt(mesh, x, p), 0.1 * p.x() - 0.2 * p.y() + 0.05, 1e-6);
  }
}

TEST(ClothTop, IsTheUpperLayersAndNothingBesideTheCloth) {
  const BagConfig bag;
  const ClothMesh mesh = MakeBagMesh(bag);
  Vec3Array x(mesh.rest.begin(), mesh.rest.end());
  float top = 0;
  for (const Vec3f& p : x) top = std::max(top, p.z());
  const Eigen::Vector2d middle(0.5 * bag.opening_m, 0.5 * bag.depth_m);
  EXPECT_NEAR(ClothTopAt(mesh, x, middle), top, 1e-6);
  EXPECT_EQ(ClothTopAt(mesh, x, {-0.1, 0.1}), -std::numeric_limits<double>::infinity());
  // On edge, it has no area to lie under.
  for (Vec3f& p : x) p = {p.x(), 0, p.y()};
  EXPECT_EQ(ClothTopAt(mesh, x, middle), -std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace gusset
