// What the benchmarks' scenes claim to be.

#include "sim/hand_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/sim/robot_fixture.h"

namespace gusset {
namespace {

// Mean way along y of the nodes of one layer, seams left out; `side` < 0: the lower one.
double MeanWay(const ClothMesh& mesh, const Vec3Array& from, const Vec3Array& to, float side) {
  double way = 0;
  int count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (mesh.rest[i].z() * side <= 0) continue;
    way += to[i].y() - from[i].y();
    ++count;
  }
  return way / count;
}

TEST(HandScene, DragDrawsTheUpperLayerAloneOverTheLower) {
  const ReadyScene scene = MakeDragScene({}, Iiwa());
  World& world = scene.hand->world();
  ASSERT_FALSE(world.cloth().state().held.empty());
  for (const HeldPoint& held : world.cloth().state().held) EXPECT_EQ(held.layer, 1);
  const Vec3Array before = world.cloth().state().x;
  int asleep = 0;
  scene.Play([&] { asleep += world.asleep() ? 1 : 0; });
  EXPECT_EQ(asleep, 0);
  EXPECT_TRUE(world.cloth().holding());
  const ClothMesh& mesh = world.cloth().mesh();
  const double lower = MeanWay(mesh, before, world.cloth().state().x, -1);
  const double upper = MeanWay(mesh, before, world.cloth().state().x, 1);
  // The lip goes 150 mm and the bottom seam nowhere, or the whole bag would have slid.
  EXPECT_LT(std::abs(lower), 0.1 * kDragWay_m);
  EXPECT_GT(upper, 0.1 * kDragWay_m);
  EXPECT_EQ(CountCrossings(mesh, world.cloth().state().x), 0);
}

TEST(HandScene, CarryKeepsTheCubeInTheBagAndBothInTheAir) {
  const ReadyScene scene = MakeCarryScene({}, Iiwa());
  World& world = scene.hand->world();
  std::set<int> layers;
  for (const HeldPoint& held : world.cloth().state().held) layers.insert(held.layer);
  EXPECT_EQ(layers, (std::set<int>{0, 1}));
  const Eigen::Vector3d before = world.cube().X_WB.translation();
  int asleep = 0;
  scene.Play([&] { asleep += world.asleep() ? 1 : 0; });
  EXPECT_EQ(asleep, 0);
  const Eigen::Vector3d after = world.cube().X_WB.translation();
  EXPECT_TRUE(world.InsideBag(after));
  EXPECT_FALSE(world.cube_held());
  // It swings behind the hand by a few centimetres at most.
  EXPECT_NEAR((after - before).x(), kCarryWay_m, 0.05);
  EXPECT_GT(world.LowestPoint(), 0.1);
  EXPECT_EQ(CountCrossings(world.cloth().mesh(), world.cloth().state().x), 0);
}

TEST(HandScene, PlaysTheSameBitsTwice) {
  const ReadyScene one = MakeDragScene({}, Iiwa()), two = MakeDragScene({}, Iiwa());
  one.Play();
  two.Play();
  EXPECT_EQ(one.hand->world().cloth().state().x, two.hand->world().cloth().state().x);
}

}  // namespace
}  // namespace gusset
