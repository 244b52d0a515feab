#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/cloth/facing.h"

namespace gusset {
namespace {

// A sheet bent along the row of nodes in its middle, both sides down by `angle` (rad).
struct Roof {
  explicit Roof(float angle) : mesh(MakeSheetMesh({})), facing(mesh) {
    const float middle = mesh.uv[static_cast<std::size_t>(mesh.node_count()) / 2].y();
    ridge_v = middle;
    for (std::size_t i = 0; i < mesh.uv.size(); ++i) {
      const float off = mesh.uv[i].y() - middle;
      x.emplace_back(mesh.uv[i].x(), middle + off * std::cos(angle),
                     -std::abs(off) * std::sin(angle), 0.0f);
    }
  }
  // An inner edge of the mesh that lies on the ridge.
  int RidgeEdge() const {
    for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
      const auto& e = mesh.edges[i];
      if (mesh.uv[e[0]].y() == ridge_v && mesh.uv[e[1]].y() == ridge_v &&
          mesh.uv[e[0]].x() > 0.1f) {
        return static_cast<int>(i);
      }
    }
    return -1;
  }
  ClothMesh mesh;
  Facing facing;
  float ridge_v = 0;
  Vec4Array x;
};

// Asked for in one lane; the others ask for what is kept straight up.
float RidgeShare(const Roof& roof, const Vec4f& outwards, std::size_t lane) {
  Facing::EdgeQuery query{};
  query.edge.fill(static_cast<std::uint16_t>(roof.RidgeEdge()));
  query.outwards_z.fill(1);
  query.outwards_x[lane] = outwards.x();
  query.outwards_y[lane] = outwards.y();
  query.outwards_z[lane] = outwards.z();
  roof.facing.FindRidgeShares(roof.x, query);
  return query.share[lane];
}

Vec4f Upwards(float lean) { return {0, std::sin(lean), std::cos(lean), 0}; }

TEST(Facing, FlatClothHasNoRidgesButItsBorder) {
  const Roof flat(0);
  std::vector<std::uint8_t> ridge;
  flat.facing.FindRidges(flat.x, ridge);
  EXPECT_EQ(RidgeShare(flat, Upwards(0), 0), 0);
  for (std::size_t i = 0; i < ridge.size(); ++i) {
    int beside = 0;
    for (const auto& t : flat.mesh.triangles) {
      int shared = 0;
      for (const int n : t) shared += n == flat.mesh.edges[i][0] || n == flat.mesh.edges[i][1];
      beside += shared == 2;
    }
    EXPECT_EQ(ridge[i], beside == 1) << "edge " << i;
  }
}

// 0 up to a fifth of ridge_sine inside the cone, 1 from all of it on; 0 outside and on the hollow
// side.
TEST(Facing, ARidgeKeepsAShareThatRisesWithinItsCone) {
  const float full = Roof(0).facing.ridge_sine();
  for (const float part : {0.1f, 0.3f, 0.6f, 0.9f, 1.5f}) {
    const float angle = std::asin(part * full);
    const Roof roof(angle);
    const auto share = [&](float lean) { return RidgeShare(roof, Upwards(lean), 5); };
    const auto expected = [&](float inside) {
      return std::clamp((std::sin(inside) / full - 0.2f) / 0.8f, 0.0f, 1.0f);
    };
    EXPECT_NEAR(share(0), expected(angle), 2e-3f) << part;
    EXPECT_NEAR(share(0.5f * angle), expected(0.5f * angle), 2e-3f) << part;
    EXPECT_NEAR(share(-0.5f * angle), share(0.5f * angle), 2e-3f) << part;
    EXPECT_EQ(share(1.1f * angle), 0) << part;
    EXPECT_EQ(share(std::numbers::pi_v<float>), 0) << part;
  }
}

// Whatever the thickness: where a ridge's edge starts to keep something, the nodes beside it keep
// nearly a thickness, and where they keep nothing, it keeps all.
TEST(Facing, ARidgeTakesOverFromTheNodesBesideIt) {
  for (const double thickness_m : {0.0002, 0.0005, 0.0015}) {
    BagConfig bag;
    bag.thickness_m = thickness_m;
    const ClothMesh mesh = MakeSheetMesh(bag);
    const Facing facing(mesh);
    const float half_edge_m = 0.5f * mesh.stretch.front().rest_m;
    const auto t = static_cast<float>(thickness_m);
    for (float sine = 0; sine < 0.3f; sine += 0.001f) {
      const float nodes = t - half_edge_m * sine;
      const float edge = t * std::clamp((sine / facing.ridge_sine() - 0.2f) / 0.8f, 0.0f, 1.0f);
      EXPECT_GT(std::max(nodes, edge), 0.4f * t) << "at " << sine;
    }
  }
}

// The search may only leave out edges that would keep nothing.
TEST(Facing, TheSearchKeepsWhatBendsByMoreThanAFifthOfARidge) {
  const float flat = 0.2f * Roof(0).facing.ridge_sine();
  for (const float angle : {0.9f * flat, 1.1f * flat}) {
    const Roof roof(angle);
    std::vector<std::uint8_t> ridge;
    roof.facing.FindRidges(roof.x, ridge);
    EXPECT_EQ(ridge[roof.RidgeEdge()], angle > flat);
  }
}

// On a roof, a node above one slope has its contact there, not at the ridge or the corners.
TEST(Facing, ABorderIsClosestOnlyWithinItsCone) {
  const Roof roof(0.3f);
  int corners = 0, sides = 0;
  for (std::size_t t = 0; t < roof.mesh.triangles.size(); ++t) {
    const auto& n = roof.mesh.triangles[t];
    for (int k = 0; k < 3; ++k) {
      const auto at_ridge = [&](int j) { return roof.mesh.uv[n[j % 3]].y() == roof.ridge_v; };
      const float u = roof.mesh.uv[n[k]].x();
      if (!at_ridge(k) || u < 0.1f || u > 0.2f) continue;
      std::array<float, 3> corner = {0, 0, 0};
      corner[k] = 1;
      EXPECT_TRUE(roof.facing.IsClosest(static_cast<int>(t), corner, Upwards(0.25f), roof.x));
      EXPECT_FALSE(roof.facing.IsClosest(static_cast<int>(t), corner, Upwards(0.35f), roof.x));
      EXPECT_FALSE(roof.facing.IsClosest(static_cast<int>(t), corner, Upwards(3), roof.x));
      ++corners;
      if (!at_ridge(k + 1)) continue;
      ++sides;
      std::array<float, 3> side = {0, 0, 0};
      side[k] = side[(k + 1) % 3] = 0.5f;
      EXPECT_TRUE(roof.facing.IsClosest(static_cast<int>(t), side, Upwards(-0.25f), roof.x));
      EXPECT_FALSE(roof.facing.IsClosest(static_cast<int>(t), side, Upwards(-0.35f), roof.x));
    }
    EXPECT_TRUE(roof.facing.IsClosest(static_cast<int>(t), {0.4f, 0.3f, 0.3f}, Upwards(1), roof.x));
  }
  EXPECT_GT(corners, 10);
  EXPECT_GT(sides, 5);
}

}  // namespace
}  // namespace gusset
