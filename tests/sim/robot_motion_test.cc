#include <gtest/gtest.h>

#include "base/random.h"
#include "sim/robot/arm.h"
#include "sim/robot/motion_planner.h"
#include "sim/robot/tool_pose.h"
#include "tests/sim/robot_fixture.h"

namespace gusset {
namespace {

// Rounding only: the planner works with a share of the limits and checks them at its grid.
constexpr double kSlack = 1e-6;

void ExpectWithinLimits(const JointState& state) {
  const ArmLimits& limits = Iiwa().limits();
  EXPECT_GE((state.q - limits.lower).minCoeff(), -kSlack);
  EXPECT_GE((limits.upper - state.q).minCoeff(), -kSlack);
  EXPECT_LE(state.qd.cwiseAbs().cwiseQuotient(limits.velocity).maxCoeff(), 1.001);
  EXPECT_LE(state.qdd.cwiseAbs().cwiseQuotient(limits.acceleration).maxCoeff(), 1 + kSlack);
}

// Runs the motion, checks limits at every millisecond, returns the largest tool speed.
double Check(const Motion& motion, const JointVector& start) {
  double fastest = 0;
  JointVector at = start;
  for (const Trajectory& trajectory : motion) {
    EXPECT_LT((trajectory.start() - at).norm(), 1e-12);
    JointState state;
    Eigen::Vector3d before = Iiwa().ToolPose(at).translation();
    JointVector q_before = at;
    JointVector qd_before = JointVector::Zero(7);
    for (double t = 0; t < trajectory.duration_s() + 0.001; t += 0.001) {
      trajectory.Evaluate(t, state);
      ExpectWithinLimits(state);
      // q, qd and qdd belong together: the trapezoid rule, off by h^3/12 of the third derivative
      // and, at the corners of qd, by h^2 times the jump of qdd.
      EXPECT_LT((state.q - q_before - 0.0005 * (state.qd + qd_before)).cwiseAbs().maxCoeff(), 2e-5);
      const Eigen::Vector3d now = Iiwa().ToolPose(state.q).translation();
      fastest = std::max(fastest, (now - before).norm() / 0.001);
      before = now;
      q_before = state.q;
      qd_before = state.qd;
    }
    at = trajectory.end();
    EXPECT_EQ(state.q, at);
  }
  return fastest;
}

Eigen::Vector3d OnDisc(Rng& rng, double radius_m, double z_m) {
  const double r = radius_m * std::sqrt(rng.Uniform());
  const double angle = rng.Uniform(0, 360 * kDegree);
  return {r * std::cos(angle), r * std::sin(angle), z_m};
}

double Tilt(const Eigen::Isometry3d& X_WT) {
  return std::acos(std::clamp(-X_WT.linear()(2, 2), -1.0, 1.0));
}

TEST(ToolPose, PositiveTiltLeansTheFingertipsAway) {
  const Eigen::Vector3d base(0, -0.44, 0.4);
  const Eigen::Isometry3d X = TiltRadially(DownwardPose({0, 0, 0.1}, 0.7), base, 0.2);
  EXPECT_TRUE(X.linear().col(2).isApprox(Eigen::Vector3d(0, std::sin(0.2), -std::cos(0.2)), 1e-12));
  EXPECT_TRUE(X.translation().isApprox(Eigen::Vector3d(0, 0, 0.1)));
  EXPECT_NEAR(X.linear().determinant(), 1, 1e-12);
}

TEST(Ik, SolvesAndKeepsTheLimits) {
  IkSolver ik(Iiwa());
  Rng rng(1);
  int solved = 0;
  for (int i = 0; i < 100; ++i) {
    JointVector q(7);
    for (int k = 0; k < 7; ++k) {
      q[k] = rng.Uniform(0.9 * Iiwa().limits().lower[k], 0.9 * Iiwa().limits().upper[k]);
    }
    const Eigen::Isometry3d X_WT = Iiwa().ToolPose(q);
    const std::optional<JointVector> found = ik.Solve(X_WT, Iiwa().waiting());
    if (!found) continue;
    ++solved;
    EXPECT_TRUE(Iiwa().WithinLimits(*found));
    EXPECT_LT((Iiwa().ToolPose(*found).matrix() - X_WT.matrix()).norm(), 1e-5);
  }
  EXPECT_GE(solved, 95);  // the posture may draw a rare solution over a limit
}

TEST(Ik, UnreachablePosesHaveNoSolution) {
  IkSolver ik(Iiwa());
  EXPECT_FALSE(ik.Solve(DownwardPose({2, 0, 0}, 0), Iiwa().waiting()));
  EXPECT_FALSE(ik.Solve(DownwardPose({std::nan(""), 0, 0}, 0), Iiwa().waiting()));
}

TEST(Ik, EqualQuestionsGetEqualAnswers) {
  IkSolver a(Iiwa()), b(Iiwa());
  (void)a.Solve(DownwardPose({0.1, 0.2, 0.3}, 1), Iiwa().waiting());
  const Eigen::Isometry3d X_WT = DownwardPose({0.1, 0, 0.1}, 0.4);
  EXPECT_EQ(*a.Solve(X_WT, Iiwa().waiting()), *b.Solve(X_WT, Iiwa().waiting()));
}

// The scene's figures for the arm, fingertips 0.20 m below the flange.
TEST(Reach, DiscIsReachedWithAtMost15DegreesOfTilt) {
  MotionPlanner planner(Iiwa());
  double most = 0;
  for (const double z : {0.0, 0.05, 0.10}) {
    for (int a = 0; a < 8; ++a) {
      for (const double r : {0.0, 0.15, 0.25}) {
        for (const double yaw : {0.0, 60.0, 120.0}) {
          const Eigen::Vector3d p(r * std::cos(a * 45 * kDegree), r * std::sin(a * 45 * kDegree),
                                  z);
          const auto q = planner.Reach(DownwardPose(p, yaw * kDegree), Iiwa().posture());
          ASSERT_TRUE(q) << p.transpose() << " yaw " << yaw;
          EXPECT_LT((Iiwa().ToolPose(*q).translation() - p).norm(), 1e-5);
          EXPECT_GE(Iiwa().CameraClearance(*q), 0.10);
          most = std::max(most, Tilt(Iiwa().ToolPose(*q)));
        }
      }
    }
  }
  EXPECT_LE(most, 15.01 * kDegree);
  EXPECT_GT(most, 5 * kDegree);  // beside the base upright is not possible
}

// With 15 degrees of tilt a cube there could never be picked up, and an episode tried five times.
TEST(Reach, ACubeBesideThePedestalsCornersIsComeToFromAbove) {
  MotionPlanner planner(Iiwa());
  double most = 0;
  for (const double x : {-0.13, -0.11, 0.11, 0.13}) {
    for (const double yaw : {0.0, 45.0, 90.0}) {
      const Eigen::Vector3d above(x, -0.295, 0.12);  // the region of interest's lower edge
      const auto there = planner.To(Iiwa().waiting(), DownwardPose(above, yaw * kDegree), 0.4);
      ASSERT_TRUE(there) << above.transpose() << " yaw " << yaw;
      Check(*there, Iiwa().waiting());
      Eigen::Isometry3d low = Iiwa().ToolPose(there->back().end());
      low.translation().z() = 0.0125;
      const auto down = planner.To(there->back().end(), low, 0.15);
      ASSERT_TRUE(down) << above.transpose() << " yaw " << yaw;
      Check(*down, there->back().end());
      most = std::max(most, Tilt(Iiwa().ToolPose(down->back().end())));
    }
  }
  EXPECT_GT(most, 15 * kDegree);
  EXPECT_LE(most, 30.01 * kDegree);
}

TEST(Reach, LiftColumnIsReachedTilted29Degrees) {
  MotionPlanner planner(Iiwa());
  for (double z = 0.05; z < 0.61; z += 0.11) {
    for (const double x : {-0.08, 0.0, 0.08}) {
      for (const double y : {-0.08, 0.0, 0.08}) {
        const Eigen::Isometry3d X_WT =
            TiltRadially(DownwardPose({x, y, z}, 0), Iiwa().X_WB().translation(), -29 * kDegree);
        const auto q = planner.Reach(X_WT, Iiwa().posture());
        ASSERT_TRUE(q) << X_WT.translation().transpose();
        EXPECT_NEAR(Tilt(Iiwa().ToolPose(*q)), 29 * kDegree, 10.01 * kDegree);
      }
    }
  }
}

TEST(Reach, CubeSidesAreReachedUpright) {
  MotionPlanner planner(Iiwa());
  for (const double x : {-0.42, 0.42}) {
    for (const double y : {-0.1, 0.0, 0.1}) {
      for (const double z : {0.0, 0.15, 0.30}) {
        const auto q = planner.Reach(DownwardPose({x, y, z}, 0), Iiwa().posture());
        ASSERT_TRUE(q) << x << " " << y << " " << z;
        EXPECT_LT(Tilt(Iiwa().ToolPose(*q)), 0.01 * kDegree);
      }
    }
  }
}

TEST(Lines, StayStraightAndKeepTheirSpeed) {
  MotionPlanner planner(Iiwa());
  Rng rng(2);
  JointVector q = *planner.Reach(DownwardPose({0, 0, 0.1}, 0), Iiwa().posture());
  int lines = 0;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d from = Iiwa().ToolPose(q).translation();
    const double z = rng.Uniform(0.01, 0.15);
    const Eigen::Vector3d to = OnDisc(rng, 0.2, z);
    const double yaw = rng.Uniform(0, 180 * kDegree);
    const auto line = planner.LineWithTolerance(q, DownwardPose(to, yaw), 0.3);
    if (!line) continue;
    ++lines;
    EXPECT_LE(Check({*line}, q), 0.3 * 1.01);  // within 1 %: speed is set at the path's samples
    JointState state;
    for (double t = 0; t < line->duration_s(); t += 0.005) {
      line->Evaluate(t, state);
      const Eigen::Vector3d along = (to - from).normalized();
      const Eigen::Vector3d off = Iiwa().ToolPose(state.q).translation() - from;
      EXPECT_LT((off - off.dot(along) * along).norm(), 0.0005);
    }
    q = line->end();
  }
  EXPECT_GE(lines, 18);
}

TEST(Lines, ReachTheAskedSpeedWhereTheLimitsAllow) {
  MotionPlanner planner(Iiwa());
  const JointVector q = *planner.Reach(DownwardPose({-0.15, 0.05, 0.1}, 0), Iiwa().posture());
  const auto line = planner.Line(q, DownwardPose({0.15, 0.05, 0.1}, 0), 0.1);
  ASSERT_TRUE(line);
  // 0.3 m at 0.1 m/s, 2 m/s^2: 3.05 s at best.
  EXPECT_GE(line->duration_s(), 3.0);
  EXPECT_LE(line->duration_s(), 3.2);
}

TEST(Motions, RandomActionsOverTheTableNeverFailAndKeepTheLimits) {
  MotionPlanner planner(Iiwa());
  Rng rng(3);
  for (int i = 0; i < 12; ++i) {
    JointVector q = Iiwa().waiting();
    const double yaw = rng.Uniform(0, 360 * kDegree);
    const Eigen::Vector3d p = OnDisc(rng, 0.25, 0.1);
    const Eigen::Vector3d lift(rng.Uniform(-0.08, 0.08), rng.Uniform(-0.08, 0.08),
                               rng.Uniform(0.1, 0.6));
    const Eigen::Vector3d cube(0.42, rng.Uniform(-0.1, 0.1), 0.15);
    const std::vector<Eigen::Isometry3d> goals = {
        DownwardPose(p, yaw),
        DownwardPose(p - Eigen::Vector3d(0, 0, 0.097), yaw),
        DownwardPose(p, yaw),
        i % 2 == 0
            ? TiltRadially(DownwardPose(lift, yaw), Iiwa().X_WB().translation(), -29 * kDegree)
            : DownwardPose(cube, yaw),
    };
    for (const Eigen::Isometry3d& goal : goals) {
      const auto motion = planner.To(q, goal, 0.4);
      ASSERT_TRUE(motion) << goal.translation().transpose();
      EXPECT_LE(Check(*motion, q), 0.4 * 1.02);
      q = motion->back().end();
      EXPECT_LT((Iiwa().ToolPose(q).translation() - goal.translation()).norm(), 1e-5);
    }
    const auto home = planner.ToWaiting(q);
    ASSERT_TRUE(home) << Iiwa().ToolPose(q).translation().transpose();
    Check(*home, q);
    EXPECT_EQ(home->back().end(), Iiwa().waiting());
  }
}

TEST(Motions, TheWayHomeNeverSinks) {
  MotionPlanner planner(Iiwa());
  for (const double x : {-0.2, 0.0, 0.2}) {
    const JointVector q = *planner.Reach(DownwardPose({x, 0.05, 0.01}, 0.3), Iiwa().posture());
    const auto home = planner.ToWaiting(q);
    ASSERT_TRUE(home);
    for (const Trajectory& trajectory : *home) {
      JointState state;
      for (double t = 0; t < trajectory.duration_s(); t += 0.005) {
        trajectory.Evaluate(t, state);
        EXPECT_GE(Iiwa().ToolPose(state.q).translation().z(), 0.01 - 0.0005);
        EXPECT_GE(Iiwa().CameraClearance(state.q), 0.099);  // checked at samples 3 degrees apart
      }
    }
  }
}

TEST(Arm, StopKeepsTheAccelerationLimitsAndThePath) {
  MotionPlanner planner(Iiwa());
  const JointVector q = *planner.Reach(DownwardPose({-0.15, 0.05, 0.1}, 0), Iiwa().posture());
  const auto line = planner.Line(q, DownwardPose({0.15, 0.05, 0.1}, 0), 0.5);
  ASSERT_TRUE(line);
  for (const double stop_s : {0.05, 0.2, 0.4, line->duration_s() - 0.01}) {
    Arm arm(Iiwa());
    arm.Place(q);
    arm.Start(*line);
    double elapsed = 0;
    while (arm.moving()) {
      if (elapsed >= stop_s) arm.Stop();
      const JointVector before = arm.state().qd;
      arm.Step(0.001);
      elapsed += 0.001;
      ExpectWithinLimits(arm.state());
      // What the joints really did in this step, the end of the motion included.
      const JointVector change = (arm.state().qd - before).cwiseAbs() / 0.001;
      EXPECT_LE(change.cwiseQuotient(Iiwa().limits().acceleration).maxCoeff(), 1.05);
      const Eigen::Vector3d p = Iiwa().ToolPose(arm.state().q).translation();
      EXPECT_NEAR(p.y(), 0.05, 0.0005);
      EXPECT_NEAR(p.z(), 0.1, 0.0005);
    }
    EXPECT_LT(elapsed, stop_s + 0.4);
    EXPECT_TRUE(arm.state().qd.isZero());
  }
}

}  // namespace
}  // namespace gusset
