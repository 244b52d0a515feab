#include <gtest/gtest.h>

#include "base/error.h"
#include "sim/robot/sim_robot.h"
#include "sim/robot/tool_pose.h"
#include "tests/sim/robot_fixture.h"

namespace gusset {
namespace {

class SimRobotInAir : public testing::Test {
 protected:
  FakeEnvironment air_;
  SimRobot robot_{Iiwa(), air_, 1};
};

// A floor that pushes back 20 N per millimetre.
Eigen::Vector3d Floor(const Eigen::Isometry3d& X_WT) {
  return {0, 0, 20'000 * std::max(0.0, 0.02 - X_WT.translation().z())};
}

TEST_F(SimRobotInAir, MovesWhereItIsTold) {
  const Eigen::Isometry3d X_WT = DownwardPose({0.1, 0.05, 0.1}, 0.5);
  const MoveResult result = robot_.MoveTo(X_WT, 0.4);
  EXPECT_EQ(result.end, MoveEnd::kReached);
  EXPECT_LT((result.X_WT.translation() - X_WT.translation()).norm(), 1e-5);
  EXPECT_TRUE(air_.X_WT.isApprox(result.X_WT, 1e-12));
  EXPECT_EQ(robot_.MoveToWaitingPose().end, MoveEnd::kReached);
  EXPECT_LT((robot_.Read().q_rad - Iiwa().waiting()).norm(), 1e-12);
}

TEST_F(SimRobotInAir, UnreachablePosesMoveNothing) {
  EXPECT_EQ(robot_.MoveTo(DownwardPose({3, 0, 0}, 0), 0.4).end, MoveEnd::kUnreachable);
  EXPECT_EQ(robot_.MoveTo(DownwardPose({std::nan(""), 0, 0}, 0), 0.4).end, MoveEnd::kUnreachable);
  EXPECT_EQ(air_.steps, 0);
  EXPECT_FALSE(robot_.Reachable(DownwardPose({3, 0, 0}, 0)));
  EXPECT_TRUE(robot_.Reachable(DownwardPose({0, 0, 0.02}, 0)));
}

TEST_F(SimRobotInAir, SpeedsAndForcesMustBePositive) {
  EXPECT_THROW(robot_.MoveTo(DownwardPose({0, 0, 0.1}, 0), 0), InputError);
  EXPECT_THROW(robot_.MoveUntilContact(DownwardPose({0, 0, 0.1}, 0), 0.1, -1), InputError);
  EXPECT_THROW(robot_.MoveGripper(0, std::nan(""), 20), InputError);
}

TEST_F(SimRobotInAir, GuardedMoveStopsAtTheFloor) {
  air_.force = Floor;
  ASSERT_EQ(robot_.MoveTo(DownwardPose({0, 0, 0.1}, 0), 0.4).end, MoveEnd::kReached);
  const MoveResult result = robot_.MoveUntilContact(DownwardPose({0, 0, 0.0}, 0), 0.05, 3);
  EXPECT_EQ(result.end, MoveEnd::kContact);
  // 3 N is felt 0.15 mm deep; 25 ms of watching and averaging and the braking add to it.
  EXPECT_LT(result.X_WT.translation().z(), 0.02);
  EXPECT_GT(result.X_WT.translation().z(), 0.02 - 0.002);
}

TEST_F(SimRobotInAir, GuardIgnoresNoiseAndWhatItCarries) {
  air_.force = [](const Eigen::Isometry3d&) { return Eigen::Vector3d(0, 0, -5); };
  ASSERT_EQ(robot_.MoveTo(DownwardPose({0, 0, 0.1}, 0), 0.4).end, MoveEnd::kReached);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(robot_.MoveUntilContact(DownwardPose({0, 0, 0.02}, 0), 0.05, 1).end,
              MoveEnd::kReached);
    EXPECT_EQ(robot_.MoveUntilContact(DownwardPose({0, 0, 0.1}, 0), 0.05, 1).end,
              MoveEnd::kReached);
  }
}

TEST_F(SimRobotInAir, FiftyNewtonsStopTheArm) {
  air_.force = Floor;
  ASSERT_EQ(robot_.MoveTo(DownwardPose({0, 0, 0.1}, 0), 0.4).end, MoveEnd::kReached);
  const MoveResult result = robot_.MoveTo(DownwardPose({0, 0, 0.0}, 0), 0.1);
  EXPECT_EQ(result.end, MoveEnd::kProtectiveStop);
  EXPECT_GT(result.X_WT.translation().z(), 0.01);
}

TEST_F(SimRobotInAir, AfterAProtectiveStopItMayRetreatButNotPressHarder) {
  air_.force = Floor;
  ASSERT_EQ(robot_.MoveTo(DownwardPose({0, 0, 0.1}, 0), 0.4).end, MoveEnd::kReached);
  const MoveResult stopped = robot_.MoveTo(DownwardPose({0, 0, 0.0}, 0), 0.1);
  ASSERT_EQ(stopped.end, MoveEnd::kProtectiveStop);
  const double pressed_N = Floor(stopped.X_WT).z();
  ASSERT_GT(pressed_N, 50);
  const MoveResult deeper = robot_.MoveTo(DownwardPose({0, 0, 0.0}, 0), 0.02);
  EXPECT_EQ(deeper.end, MoveEnd::kProtectiveStop);
  // A tenth more stops it; 25 ms of watching and the braking at 20 mm/s add up to a millimetre.
  EXPECT_LT(Floor(deeper.X_WT).z(), 1.1 * pressed_N + 20);
  // The floor pushes as before, and the way up is free.
  EXPECT_EQ(robot_.MoveTo(DownwardPose({0, 0, 0.1}, 0), 0.1).end, MoveEnd::kReached);
}

TEST_F(SimRobotInAir, TorqueBeyondTheMotorsStopsTheArm) {
  RobotConfig config;
  config.stop_force_N = 1000;  // only the torque limits are left
  const ArmModel arm =
      ArmModel::Load(config, std::filesystem::path(GUSSET_SOURCE_DIR) / "assets", false);
  SimRobot robot(arm, air_, 1);
  air_.force = [](const Eigen::Isometry3d&) { return Eigen::Vector3d(0, 0, -600); };
  EXPECT_EQ(robot.MoveTo(DownwardPose({0, 0, 0.2}, 0), 0.2).end, MoveEnd::kProtectiveStop);
}

TEST_F(SimRobotInAir, GripperClosesAtItsRealSpeedAndHoldsWhatItFinds) {
  air_.blocked = [](double opening_m) { return opening_m <= 0.0012; };
  EXPECT_NEAR(robot_.MoveGripper(0, 0.05, 40), 0.0012, 0.0001 + 1e-9);  // one step: 0.1 mm
  // (85 - 1.2) mm at twice 50 mm/s.
  EXPECT_NEAR(air_.steps * 0.001, 0.838, 0.002);
  EXPECT_EQ(air_.hold_N, 40);
  EXPECT_TRUE(robot_.Save().holding);
  robot_.MoveGripper(0.085, 10, 40);
  EXPECT_EQ(air_.hold_N, 0);
  // 10 m/s is not to be had: 150 mm/s per finger.
  EXPECT_NEAR(air_.steps * 0.001, 0.838 + 0.0838 / 0.3, 0.003);
}

TEST_F(SimRobotInAir, GripperStopsAtItsForce) {
  air_.pad_force = [](double opening_m) { return 50'000 * std::max(0.0, 0.035 - opening_m); };
  const double opening_m = robot_.MoveGripper(0, 0.02, 30);
  EXPECT_NEAR(opening_m, 0.035 - 30.0 / 50'000, 0.00005);
  EXPECT_EQ(air_.hold_N, 30);
}

TEST_F(SimRobotInAir, PartlyOpenFingersHoldNothing) {
  EXPECT_NEAR(robot_.MoveGripper(0.03, 0.1, 30), 0.03, 1e-12);
  EXPECT_FALSE(robot_.Save().holding);
}

TEST_F(SimRobotInAir, WaitingIsRest) {
  robot_.Wait(0.25);
  EXPECT_EQ(air_.steps, 250);
  EXPECT_EQ(air_.rest_steps, 250);
}

TEST_F(SimRobotInAir, RestoredRobotDoesExactlyTheSame) {
  robot_.MoveTo(DownwardPose({0.1, 0, 0.1}, 0.5), 0.4);
  robot_.MoveGripper(0.02, 0.1, 30);
  const SimRobotState state = robot_.Save();
  const auto act = [](SimRobot& robot) {
    robot.SeedSensors(99);
    robot.MoveUntilContact(DownwardPose({0.1, 0, 0.05}, 0.2), 0.1, 2);
    return robot.Read();
  };
  FakeEnvironment other_air;
  SimRobot other(Iiwa(), other_air, 5);
  other.Restore(state);
  const RobotReading a = act(robot_);
  const RobotReading b = act(other);
  EXPECT_EQ(a.q_rad, b.q_rad);
  EXPECT_EQ(a.torque_Nm, b.torque_Nm);
  EXPECT_EQ(a.tool_force_N, b.tool_force_N);
  EXPECT_EQ(a.gripper_opening_m, b.gripper_opening_m);
}

TEST_F(SimRobotInAir, ToolForceReadsTheLoad) {
  air_.force = [](const Eigen::Isometry3d&) { return Eigen::Vector3d(0, 0, -5); };
  EXPECT_NEAR(robot_.Read().tool_force_N, 5, 0.3);  // 0.3 N of noise per reading, 16 averaged
}

}  // namespace
}  // namespace gusset
