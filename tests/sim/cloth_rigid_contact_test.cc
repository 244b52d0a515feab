#include <gtest/gtest.h>

#include <stdexcept>

#include "sim/cloth/rigid_contact.h"
#include "sim/hand_scene.h"

namespace gusset {
namespace {

constexpr float kStep_s = 1 / 600.0f;
constexpr float kHalf_m = 0.0175f;
constexpr float kDeep_m = 0.001f;
constexpr float kLevel_m = 0.3f;

// A flat layer, and a cube below it whose top (an edge or a corner) comes up through it, where no
// node, edge midpoint or face centre is within 3 mm: 1 mm up, it is within half a thickness of
// none.
class BoxFromBelow : public testing::TestWithParam<Eigen::Vector3f> {
 protected:
  BoxFromBelow() {
    for (const Vec3f& p : LaidFlat({}).x) x_.emplace_back(p.x(), p.y(), 0.0f, 0.0f);
    // The other layer is out of the way.
    for (std::size_t i = 0; i < x_.size(); ++i) x_[i].z() = mesh_.rest[i].z() < 0 ? 0 : kLevel_m;
    for (const float m : mesh_.mass_kg) inv_mass_.push_back(1 / m);
    const auto& n = TopTriangle();
    top_ = 0.65f * x_[n[0]].head<3>() + 0.175f * (x_[n[1]] + x_[n[2]]).head<3>();
    RigidShape box;
    box.half = Vec3f::Constant(kHalf_m);
    box.inv_mass = 1 / 0.04f;
    box.inv_inertia_W = Eigen::Matrix3f::Identity() * (6 * box.inv_mass / (4 * kHalf_m * kHalf_m));
    const Vec3f up = GetParam();
    box.X_WS.linear() = Eigen::Quaternionf::FromTwoVectors(up, Vec3f::UnitZ()).toRotationMatrix();
    top_S_ = kHalf_m * up;
    box.X_WS.translation() = top_ + Vec3f(0, 0, kDeep_m) - box.X_WS.linear() * top_S_;
    box.X_WS_prev = box.X_WS;
    box.X_WS_prev.translation().z() -= 0.003f;  // it came from below
    shapes_.push_back(box);
  }

  // In the middle of the upper layer.
  const std::array<int, 3>& TopTriangle() const {
    for (const auto& t : mesh_.triangles) {
      const Vec3f p = (x_[t[0]] + x_[t[1]] + x_[t[2]]).head<3>() / 3;
      if (p.z() > 0.99f * kLevel_m && p.head<2>().norm() < 0.02f) return t;
    }
    throw std::logic_error("no such triangle");
  }
  // Of the box's top below the triangle's plane.
  float Distance() const {
    const auto& n = TopTriangle();
    const Vec3f a = x_[n[0]].head<3>(), b = x_[n[1]].head<3>(), c = x_[n[2]].head<3>();
    Vec3f normal = (b - a).cross(c - a).normalized();
    if (normal.z() < 0) normal = -normal;
    return normal.dot(a - shapes_[0].X_WS * top_S_);
  }
  void Solve(int passes) {
    const Vec4Array x_prev = x_;
    ASSERT_TRUE(contact_.Find(x_, shapes_));
    for (int i = 0; i < passes; ++i) contact_.Solve(x_prev, inv_mass_, kStep_s, shapes_, x_);
  }

  ClothMesh mesh_ = MakeBagMesh({});
  RigidContact contact_{mesh_, 0.21f, 0.05f};
  Vec4Array x_;
  std::vector<float> inv_mass_;
  std::vector<RigidShape> shapes_;
  Vec3f top_, top_S_;
};

TEST_P(BoxFromBelow, DoesNotComeThroughBetweenTheSamples) {
  ASSERT_NEAR(Distance(), -kDeep_m, 1e-5f);
  Solve(20);
  // Half a thickness; Gauss-Seidel leaves little after so many passes.
  EXPECT_GT(Distance(), 0.45f * mesh_.thickness_m);
  // Triangles side by side share nodes, so what one needs lifts the others too.
  EXPECT_LT(Distance(), mesh_.thickness_m) << "thrown off";
}

TEST_P(BoxFromBelow, GetsTheMomentumThatTheClothLoses) {
  const Vec4Array before = x_;
  Solve(1);
  Vec3f cloth = Vec3f::Zero();
  for (std::size_t i = 0; i < x_.size(); ++i) {
    cloth += (x_[i] - before[i]).head<3>() / (inv_mass_[i] * kStep_s);
  }
  EXPECT_GT(cloth.z(), 0);
  EXPECT_LT((cloth + shapes_[0].impulse).norm(), 1e-3f * cloth.norm());
}

// Cloth that was too close to the box already is pushed away from it, but keeps no speed of that,
// and the box gets what it loses.
TEST_P(BoxFromBelow, ThrowsNothingThatWasTooClose) {
  shapes_[0].X_WS_prev = shapes_[0].X_WS;
  const Vec4Array before = x_;
  Solve(2);
  Vec4Array v;
  for (std::size_t i = 0; i < x_.size(); ++i) v.push_back((x_[i] - before[i]) / kStep_s);
  const auto momentum = [&] {
    Vec3f sum = Vec3f::Zero();
    for (std::size_t i = 0; i < v.size(); ++i) sum += v[i].head<3>() / inv_mass_[i];
    return sum;
  };
  const Vec3f thrown = momentum(), impulse = shapes_[0].impulse;
  ASSERT_GT(thrown.z(), 0);
  contact_.EndSubstep(inv_mass_, kStep_s, v);
  const Vec3f lost = thrown - momentum(), gained = shapes_[0].impulse - impulse;
  EXPECT_NEAR(lost.z(), thrown.z(), 0.1f * thrown.z())
      << "cloth and box were thrown apart, and both stop";
  EXPECT_LT((lost - gained).norm(), 1e-3f * lost.norm());
}

TEST_P(BoxFromBelow, FindsNothingOfClothThatIsClear) {
  shapes_[0].X_WS.translation().z() -= kDeep_m + 0.51f * mesh_.thickness_m;
  const Vec4Array before = x_;
  Solve(2);
  EXPECT_EQ(x_, before);
}

INSTANTIATE_TEST_SUITE_P(CornerOrEdgeUp, BoxFromBelow,
                         testing::Values(Eigen::Vector3f(1, 1, 1), Eigen::Vector3f(-1, 1, 1),
                                         Eigen::Vector3f(0, 1, 1)));

}  // namespace
}  // namespace gusset
