#include "sim/top_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "sim/render/statics.h"

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

const CameraModel kCamera = OverheadCamera({}, 1.066);
constexpr std::array<int, 4> kFrame = {0, 0, 640, 480};

// Nodes of the flat bag around the table's middle, the rim towards -y.
Vec3Array Flat(const BagConfig& bag, const ClothMesh& mesh) {
  Vec3Array x(mesh.rest.begin(), mesh.rest.end());
  for (Vec3f& p : x) {
    p.x() -= static_cast<float>(0.5 * bag.opening_m);
    p.y() -= static_cast<float>(0.5 * bag.depth_m);
  }
  return x;
}

TopView LookAt(const BagConfig& bag, const Vec3Array& x, const TriMesh* cube_W = nullptr) {
  return LookAtBag(MakeBagMesh(bag), x, MakeLabels(bag), kCamera, kFrame, cube_W);
}

long Count(const TopView& view, Shown shown) { return std::ranges::count(view.shown, shown); }

TEST(TopView, AFlatBagShowsTheOutsideOfItsUpperLayer) {
  const BagConfig bag;
  const TopView view = LookAt(bag, Flat(bag, MakeBagMesh(bag)));
  // A pixel row may belong to either of two triangles along the seams, where layers meet.
  EXPECT_NEAR(Count(view, Shown::kOuter1), view.bag_px, 0.01 * view.bag_px);
  EXPECT_EQ(Count(view, Shown::kInner0) + Count(view, Shown::kInner1) + view.cube_px, 0);
  EXPECT_NEAR(view.bag_px, 34950, 0.01 * 34950);
}

TEST(TopView, TurnedOverItShowsTheOutsideOfTheOther) {
  const BagConfig bag;
  Vec3Array x = Flat(bag, MakeBagMesh(bag));
  for (Vec3f& p : x) p = {-p.x(), p.y(), 0.01f - p.z()};
  const TopView view = LookAt(bag, x);
  EXPECT_NEAR(Count(view, Shown::kOuter0), view.bag_px, 0.01 * view.bag_px);
}

// The upper layer's rim half folded back onto itself: the lower layer's inside shows beside the
// upper layer's inside, which is now on top.
TEST(TopView, AMouthDrawnBackShowsBothInsides) {
  const BagConfig bag;
  const ClothMesh mesh = MakeBagMesh(bag);
  Vec3Array x = Flat(bag, mesh);
  float top = 0;
  for (const Vec3f& p : x) top = std::max(top, p.z());
  for (Vec3f& p : x) {
    const float fold = static_cast<float>(-0.5 * bag.depth_m + 0.06);
    if (p.z() < top || p.y() >= fold) continue;
    p.y() = 2 * fold - p.y();
    p.z() += 0.01f;
  }
  const TopView view = LookAt(bag, x);
  EXPECT_GT(Count(view, Shown::kInner0), 1000);
  EXPECT_GT(Count(view, Shown::kInner1), 1000);
  // Where the lower layer shows it is near the rim: at most the 0.06 m and a node's spacing.
  for (std::size_t at = 0; at < view.shown.size(); ++at) {
    if (view.shown[at] != Shown::kInner0) continue;
    ASSERT_LE(view.rim_m[at], 0.06 + 0.021);
  }
}

// The cube's face at 0.035 m covers (0.035 * 615 / 1.031)^2 = 436 px^2, less than a pixel row of
// error.
TEST(TopView, TheCubeShowsWhereNoClothIsAboveIt) {
  const BagConfig bag;
  const Vec3Array x = Flat(bag, MakeBagMesh(bag));
  TriMesh cube = BoxMesh(Eigen::Vector3d::Constant(0.035));
  for (Eigen::Vector3f& p : cube.vertices) p.z() += 0.03f;
  const TopView on_top = LookAt(bag, x, &cube);
  EXPECT_NEAR(on_top.cube_px, 440, 42);
  EXPECT_EQ(on_top.bag_px, LookAt(bag, x).bag_px) << "the bag is there under the cube too";
  for (Eigen::Vector3f& p : cube.vertices) p.z() -= 0.2f;
  EXPECT_EQ(LookAt(bag, x, &cube).cube_px, 0);
}

}  // namespace
}  // namespace gusset
