#include "sim/world.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/stop.h"
#include "sim/hand_scene.h"
#include "sim/pedestal.h"
#include "sim/snapshot.h"
#include "tests/sim/robot_fixture.h"

namespace gusset {
namespace {

std::vector<Eigen::Isometry3d> WaitingLinks() {
  std::vector<Eigen::Isometry3d> X_WL;
  Iiwa().LinkPoses(Iiwa().waiting(), Iiwa().max_opening_m(), X_WL);
  return X_WL;
}

// Bag and cube on the table, the arm waiting far from both.
class Scene {
 public:
  Scene() : Scene(WorldConfig{}, ClothSolverConfig{}) {}
  explicit Scene(const WorldState& state)
      : world(BagConfig{}, ClothSolverConfig{}, WorldConfig{}, Iiwa()) {
    Start(state);
  }
  Scene(const WorldConfig& config, const ClothSolverConfig& solver)
      : world(BagConfig{}, solver, config, Iiwa()) {
    WorldState state;
    state.cloth = LaidFlat({});
    state.cube = world.cube();
    Start(state);
  }
  void Steps(int count) {
    for (int i = 0; i < count; ++i) world.Step(X_WL, Iiwa().max_opening_m(), true);
  }

  World world;

 private:
  void Start(const WorldState& state) {
    world.SetState(state);
    world.PlaceArm(X_WL, Iiwa().max_opening_m());
  }
  std::vector<Eigen::Isometry3d> X_WL = WaitingLinks();
};

SimRobotState Waiting() {
  SimRobotState robot;
  robot.q = Iiwa().waiting();
  robot.opening_m = Iiwa().max_opening_m();
  return robot;
}

TEST(World, CubeRestsOnTheTableWhereItWaits) {
  Scene scene;
  scene.world.Settle(0.5);
  const Eigen::Vector3d p = scene.world.cube().X_WB.translation();
  // Bullet lets bodies sink into each other by a fraction of their margins of 0.5 mm.
  EXPECT_NEAR(p.z(), 0.0175, 0.0005);
  EXPECT_NEAR(p.x(), 0.42, 0.0005);
  EXPECT_NEAR(p.y(), 0, 0.0005);
  EXPECT_LT(scene.world.cube().v_m_s.norm(), 0.003);
  EXPECT_FALSE(scene.world.cube_held());
  EXPECT_FALSE(scene.world.InsideBag(p));
}

TEST(World, StepsNoFurtherOnceAStopIsAskedFor) {
  Scene scene;
  scene.world.Settle(0.1);
  const double before = scene.world.time_s();
  RequestStop();
  EXPECT_THROW(scene.world.Settle(0.1), Interrupted);
  ForgetStop();
  EXPECT_EQ(scene.world.time_s(), before);
}

TEST(World, TheCubeStopsAtTheArmsPedestal) {
  WorldState state = Scene().world.state();
  state.cube.X_WB.translation() = Eigen::Vector3d(0.02, -0.24, 0.0175);
  state.cube.v_m_s = {0, -1.5, 0};
  Scene scene(state);
  double least_y = 0;
  for (int i = 0; i < 600; ++i) {
    scene.Steps(1);
    least_y = std::min(least_y, scene.world.cube().X_WB.translation().y());
  }
  // Its middle is half a side from the pedestal's face when it touches.
  const double face_y = Pedestal().centre_m.y() + 0.5 * Pedestal().size_m.y();
  EXPECT_NEAR(least_y, face_y + 0.0175, 0.003);
}

// Its far edge lies 25 mm over the pedestal's: it tips and slides down in front of it.
TEST(World, ABagSlidesOffTheArmsPedestal) {
  WorldState state = Scene().world.state();
  const double face_y = Pedestal().centre_m.y() + 0.5 * Pedestal().size_m.y();
  const double top_m = Pedestal().centre_m.z() + 0.5 * Pedestal().size_m.z();
  float least_y = 0;
  for (const Vec3f& p : state.cloth.x) least_y = std::min(least_y, p.y());
  const Vec3f there(0, static_cast<float>(face_y - 0.025) - least_y,
                    static_cast<float>(top_m + 0.005));
  for (Vec3f& p : state.cloth.x) p += there;
  Scene scene(state);
  double deepest_m = 0, lowest_m = top_m;
  for (int i = 0; i < 900; ++i) {
    scene.Steps(1);
    for (const Vec3f& p : scene.world.cloth().state().x) {
      lowest_m = std::min<double>(lowest_m, p.z());
      if (std::abs(p.x()) > 0.12f) continue;
      deepest_m = std::max(deepest_m, std::min(face_y - p.y(), top_m - p.z()));
    }
  }
  EXPECT_LT(deepest_m, 0.003);
  EXPECT_LT(lowest_m, 0.005) << "it has come down";
}

TEST(World, AFlatBagFallsAsleepAndThenStaysAsItIs) {
  Scene scene;
  scene.world.Settle(3);
  ASSERT_TRUE(scene.world.asleep());
  const Vec3Array before = scene.world.cloth().state().x;
  scene.world.Settle(1);
  EXPECT_EQ(scene.world.cloth().state().x, before);
}

// How far nodes moved before the snapshot is not in it.
TEST(World, ARestThatHadButBegunBeginsAnewInARestoredWorld) {
  Scene lying;
  lying.world.Settle(3);
  WorldState state = lying.world.state();
  ASSERT_TRUE(Scene(state).world.asleep());
  const double rest_time_s = WorldConfig().rest_time_s;
  state.rest_s = 0.9 * rest_time_s;
  Scene scene(state);
  scene.world.Settle(0.5 * rest_time_s);
  EXPECT_FALSE(scene.world.asleep());
  scene.world.Settle(rest_time_s);
  EXPECT_TRUE(scene.world.asleep());
}

// What slides is awake for as long as friction takes to stop it, and the rest's time on top.
TEST(World, ABagThatSlidesFallsAsleepOnceItHasStopped) {
  constexpr float kSpeed_m_s = 1.5f;
  Scene lying;
  lying.world.Settle(3);
  WorldState state = lying.world.state();
  for (Vec3f& v : state.cloth.v) v = Vec3f(kSpeed_m_s, 0, 0);
  state.rest_s = 0;
  Scene scene(state);
  int steps = 0;
  for (; steps < 3000 && !scene.world.asleep(); ++steps) scene.Steps(1);
  const double slides_s = kSpeed_m_s / (BagConfig().friction_table * kGravity_m_s2);
  EXPECT_GT(steps * scene.world.step_s(), slides_s + 0.9 * WorldConfig().rest_time_s);
  EXPECT_LT(steps * scene.world.step_s(), slides_s + 1);
}

// The hand with its fingers wide open.
std::vector<Eigen::Isometry3d> OpenHandAt(const Eigen::Vector3d& p_W) {
  return HandAt(Iiwa(), p_W, Iiwa().max_opening_m());
}

TEST(World, AHandWakesTheClothThatItComesNearAndNoOther) {
  Scene scene;
  scene.world.Settle(3);
  ASSERT_TRUE(scene.world.asleep());
  const double opening = Iiwa().max_opening_m();
  // Over the middle, 2 cm above the cloth; beside the bag, above the bare table.
  scene.world.Step(OpenHandAt({0, 0, 0.02}), opening, false);
  EXPECT_TRUE(scene.world.asleep());
  scene.world.Step(OpenHandAt({0.25, 0, 0.001}), opening, false);
  EXPECT_TRUE(scene.world.asleep());
  scene.world.Step(OpenHandAt({0, 0, 0.004}), opening, false);
  EXPECT_FALSE(scene.world.asleep());
}

TEST(World, AHandFeelsTheBareTableWhileTheClothSleeps) {
  Scene scene;
  scene.world.Settle(3);
  ASSERT_TRUE(scene.world.asleep());
  for (int i = 0; i < 30; ++i) {
    scene.world.Step(OpenHandAt({0.25, 0, -0.0005}), Iiwa().max_opening_m(), false);
  }
  EXPECT_GT(scene.world.ForceOnTool().z(), 5);
}

// The fingers without their arm: their tip, straight down, is at a place.
class Fingers {
 public:
  explicit Fingers(double opening_m) : opening_m_(opening_m) {
    Iiwa().LinkPoses(Iiwa().waiting(), opening_m, X_WL_);
  }
  void Put(World& world, const Eigen::Vector3d& tip) { world.PlaceArm(At(tip), opening_m_); }
  void Step(World& world, const Eigen::Vector3d& tip) { world.Step(At(tip), opening_m_, false); }

 private:
  std::vector<Eigen::Isometry3d> At(const Eigen::Vector3d& tip) const {
    const int tip_link = *Iiwa().robot().FindLink(Iiwa().config().tip_link);
    std::vector<Eigen::Isometry3d> moved = X_WL_;
    for (const int link : {Iiwa().finger_link_a(), Iiwa().finger_link_b(), tip_link}) {
      moved[link].pretranslate(tip - X_WL_[tip_link].translation());
    }
    return moved;
  }
  double opening_m_;
  std::vector<Eigen::Isometry3d> X_WL_;
};

// Coulomb: what a cube takes that slides at constant speed.
TEST(World, AHandThatPushesTheCubeFeelsItsFriction) {
  Scene scene;
  Fingers fingers(0);
  Eigen::Vector3d tip = scene.world.cube().X_WB.translation() + Eigen::Vector3d(0, 0.06, -0.012);
  fingers.Put(scene.world, tip);
  const double v_m_s = 0.05, step_s = scene.world.step_s();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  int readings = 0;
  for (double t = 0; t < 2.5; t += step_s) {
    tip.y() -= v_m_s * step_s;
    fingers.Step(scene.world, tip);
    if (t < 1.5) continue;
    sum += scene.world.ForceOnTool();
    ++readings;
  }
  const WorldConfig config;
  const Eigen::Vector3d felt_N = sum / readings;
  // The fingers carry some of its weight by their own friction.
  const double weight_N = config.cube_mass_kg * 9.81;
  const double friction_N = config.cube_friction * (weight_N + felt_N.z());
  EXPECT_LE(std::abs(felt_N.z()), 0.5 * weight_N);
  EXPECT_NEAR(felt_N.y(), friction_N, 0.1 * friction_N);
  EXPECT_NEAR(felt_N.x(), 0, 0.25 * friction_N) << "the cube turns a little";
}

TEST(World, AHandFeelsTheCubeThatItComesDownOn) {
  Scene scene;
  scene.world.Settle(0.2);
  const Eigen::Vector3d cube = scene.world.cube().X_WB.translation();
  Fingers fingers(0);
  Eigen::Vector3d tip = cube + Eigen::Vector3d(0, 0, 0.06);
  fingers.Put(scene.world, tip);
  const double start_m = tip.z();
  while (scene.world.ForceOnTool().z() < 1 && tip.z() > cube.z()) {
    tip.z() -= 0.02 * scene.world.step_s();
    fingers.Step(scene.world, tip);
    if (tip.z() > start_m - 0.01) {
      ASSERT_LT(scene.world.ForceOnTool().norm(), 0.01) << "nothing is there yet";
    }
  }
  EXPECT_NEAR(tip.z(), cube.z() + 0.0175, 0.0005);
  EXPECT_NEAR(scene.world.cube().X_WB.translation().z(), cube.z(), 0.0005);
}

// Springs in a row, of two fingers on the cube and of the cube on the table, whatever the cube
// weighs and however long a substep is.
TEST(World, ThePressedCubeIsAsStiffAsItsContacts) {
  for (const double mass_kg : {0.02, 0.2}) {
    for (const int substeps_per_s : {300, 600}) {
      WorldConfig config;
      config.cube_mass_kg = mass_kg;
      ClothSolverConfig solver;
      solver.substeps_per_s = substeps_per_s;
      Scene scene(config, solver);
      scene.world.Settle(0.2);
      Fingers fingers(0);
      Eigen::Vector3d tip = scene.world.cube().X_WB.translation() + Eigen::Vector3d(0, 0, 0.03);
      fingers.Put(scene.world, tip);
      const double touched_m = tip.z() - 0.03 + 0.0175, lowest_m = touched_m - 0.001;
      while (tip.z() > lowest_m) {
        tip.z() -= 0.02 * scene.world.step_s();
        fingers.Step(scene.world, tip);
      }
      for (double t = 0; t < 0.2; t += scene.world.step_s()) fingers.Step(scene.world, tip);
      EXPECT_NEAR(scene.world.ForceOnTool().z(), 2e4 * (touched_m - tip.z()), 3)
          << mass_kg << " kg, " << substeps_per_s << " substeps a second";
    }
  }
}

TEST(World, AHandFeelsTheWeightOfAHeldCubeAndTheTableThatItIsSetOn) {
  Scene scene;
  scene.world.Settle(0.2);
  const WorldConfig config;
  const double lies_m = scene.world.cube().X_WB.translation().z();
  Fingers fingers(config.cube_side_m);
  Eigen::Vector3d tip = scene.world.cube().X_WB.translation();
  fingers.Put(scene.world, tip);
  scene.world.BeginHold(60);
  ASSERT_TRUE(scene.world.cube_held());
  while (tip.z() < lies_m + 0.02) {
    tip.z() += 0.05 * scene.world.step_s();
    fingers.Step(scene.world, tip);
  }
  for (double t = 0; t < 0.5; t += scene.world.step_s()) fingers.Step(scene.world, tip);
  const double weight_N = config.cube_mass_kg * 9.81;
  EXPECT_NEAR(scene.world.ForceOnTool().z(), -weight_N, 0.02 * weight_N);
  while (scene.world.ForceOnTool().z() < 1 && tip.z() > lies_m - 0.005) {
    tip.z() -= 0.02 * scene.world.step_s();
    fingers.Step(scene.world, tip);
  }
  EXPECT_NEAR(scene.world.cube().X_WB.translation().z(), lies_m, 0.0005);
  EXPECT_NEAR(tip.z(), lies_m, 0.001);
  // Pressed harder than the pads can hold it, it slips.
  while (scene.world.cube_held() && tip.z() > lies_m - 0.005) {
    tip.z() -= 0.02 * scene.world.step_s();
    fingers.Step(scene.world, tip);
  }
  EXPECT_FALSE(scene.world.cube_held());
}

// Mid-planes of the two layers lie half and one and a half thicknesses above the table, so the
// fingertips' height alone decides what is held.
TEST(World, FingertipHeightDecidesWhichLayersAreHeld) {
  Scene scene;
  scene.world.Settle(0.5);
  Cloth& cloth = scene.world.cloth();
  const auto layers_held_at = [&](float tip_m) {
    PadGap gap;
    gap.X_WT.linear() = Vec3f(1, -1, -1).asDiagonal();
    gap.X_WT.translation() = Vec3f(0, 0, tip_m);
    gap.opening_m = 0.010f;
    cloth.BeginHold(gap, 20);
    std::set<int> layers;
    for (const HeldPoint& held : cloth.state().held) layers.insert(held.layer);
    cloth.EndHold();
    return layers;
  };
  EXPECT_EQ(layers_held_at(0.0f), (std::set<int>{0, 1}));
  EXPECT_EQ(layers_held_at(0.0015f), (std::set<int>{1}));
  EXPECT_EQ(layers_held_at(0.004f), (std::set<int>{}));
}

TEST(World, ASnapshotGoesOnWithTheSameBitsWhateverElseIsStepped) {
  Scene scene;
  scene.world.Settle(0.05);  // still falling: every array matters
  ASSERT_FALSE(scene.world.asleep());
  const std::string bytes = PackSnapshot(scene.world.state(), Waiting());
  WorldState state;
  SimRobotState robot;
  UnpackSnapshot(bytes, state, robot);
  EXPECT_EQ(PackSnapshot(state, robot), bytes);

  Scene alone(state), beside_another(state), another;
  alone.Steps(50);
  for (int i = 0; i < 50; ++i) {
    another.Steps(1);
    beside_another.Steps(1);
  }
  const std::string expected = PackSnapshot(alone.world.state(), robot);
  EXPECT_NE(expected, bytes) << "nothing moved: the test shows nothing";
  EXPECT_EQ(PackSnapshot(beside_another.world.state(), robot), expected);
}

TEST(Snapshot, RefusesBytesThatAreCutShortOrForeign) {
  const Scene scene;
  const std::string bytes = PackSnapshot(scene.world.state(), Waiting());
  WorldState state;
  SimRobotState robot;
  for (const std::size_t length :
       {std::size_t{0}, std::size_t{5}, bytes.size() / 3, bytes.size() / 2, bytes.size() - 1}) {
    EXPECT_THROW(UnpackSnapshot(bytes.substr(0, length), state, robot), InputError) << length;
  }
  EXPECT_THROW(UnpackSnapshot(bytes + '\0', state, robot), InputError);
  EXPECT_THROW(UnpackSnapshot("a photograph", state, robot), InputError);
}

// A node a hundred metres away is a number like any other, and keeps a world busy for hours.
TEST(Snapshot, RefusesAnyBitThatHasChanged) {
  const Scene scene;
  const std::string bytes = PackSnapshot(scene.world.state(), Waiting());
  WorldState state;
  SimRobotState robot;
  for (std::size_t i = 0; i < bytes.size(); i += 1 + bytes.size() / 50) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 1);
    EXPECT_THROW(UnpackSnapshot(changed, state, robot), InputError) << "byte " << i;
  }
}

}  // namespace
}  // namespace gusset
