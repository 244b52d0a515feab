#include "sim/robot/sim_robot.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace gusset {
namespace {

// The arm's controller looks at its sensors every 5 ms and averages what it saw over 20 ms: steady
// enough for guards of 1 N, and quick enough to stop within a millimetre at 0.05 m/s. tuned
constexpr double kWatchPeriod_s = 0.005;
constexpr std::size_t kWatchWindow = 4;
constexpr int kReadingsAtRest = 16;          // averaged for one Read and for a guard's start; tuned
constexpr double kClosedOpening_m = 0.0005;  // fingers nearer than this count as closed; tuned
// After a protective stop the tool may still be pressed upon: a motion that begins so goes on while
// the force grows no further than by this factor, or there would be no way back.
constexpr double kRetreatFactor = 1.1;

void RequirePositive(double value, const char* what) {
  if (std::isfinite(value) && value > 0) return;
  throw InputError(std::string(what) + " = " + std::to_string(value) + " is not above 0");
}

}  // namespace

SimRobot::SimRobot(const ArmModel& arm, ArmEnvironment& environment, std::uint64_t sensor_seed)
    : arm_model_(arm),
      environment_(environment),
      planner_(arm),
      sensors_(arm, sensor_seed),
      arm_(arm),
      opening_m_(arm.max_opening_m()) {
  arm_model_.LinkPoses(arm_.state().q, opening_m_, X_WL_);
}

void SimRobot::StepWorld(bool at_rest) {
  if (!at_rest) arm_model_.LinkPoses(arm_.state().q, opening_m_, X_WL_);
  environment_.Step(X_WL_, opening_m_, at_rest);
}

// One look at the sensors. What has to end the motion, if anything.
std::optional<MoveEnd> SimRobot::Watch(const Guard* guard) {
  const Eigen::Vector3d force_W = environment_.ForceOnTool();
  forces_W_.push_back(sensors_.Force(arm_.state(), force_W));
  if (forces_W_.size() > kWatchWindow) forces_W_.pop_front();
  Eigen::Vector3d mean_W = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& force : forces_W_) mean_W += force;
  mean_W /= static_cast<double>(forces_W_.size());
  if (forces_W_.size() == 1) {
    force_bound_N_ = std::max(arm_model_.config().stop_force_N, kRetreatFactor * mean_W.norm());
  }

  const JointVector torques = sensors_.TrueTorques(arm_.state(), force_W);
  if ((torques.cwiseAbs() - arm_model_.limits().torque).maxCoeff() > 0 ||
      mean_W.norm() > force_bound_N_) {
    return MoveEnd::kProtectiveStop;
  }
  if (guard == nullptr || forces_W_.size() < kWatchWindow) return std::nullopt;
  const Eigen::Vector3d change_W = mean_W - guard->force_at_start_W;
  const double felt_N =
      guard->direction_W.isZero() ? change_W.norm() : -guard->direction_W.dot(change_W);
  if (felt_N > guard->force_N) return MoveEnd::kContact;
  return std::nullopt;
}

MoveResult SimRobot::Run(const std::optional<Motion>& motion, const Guard* guard) {
  if (!motion) return {MoveEnd::kUnreachable, ToolPose()};
  const double step_s = environment_.step_s();
  const int watch_every = std::max(1, static_cast<int>(std::lround(kWatchPeriod_s / step_s)));
  MoveEnd end = MoveEnd::kReached;
  forces_W_.clear();
  int step = 0;
  for (const Trajectory& trajectory : *motion) {
    arm_.Start(trajectory);
    while (arm_.moving()) {
      arm_.Step(step_s);
      StepWorld(false);
      if (end != MoveEnd::kReached || ++step % watch_every != 0) continue;
      if (const std::optional<MoveEnd> stop = Watch(guard)) {
        end = *stop;
        arm_.Stop();
      }
    }
    if (end != MoveEnd::kReached) break;
  }
  return {end, ToolPose()};
}

MoveResult SimRobot::MoveTo(const Eigen::Isometry3d& X_WT, double speed_m_s) {
  RequirePositive(speed_m_s, "MoveTo: speed_m_s");
  if (!X_WT.matrix().allFinite()) return {MoveEnd::kUnreachable, ToolPose()};
  return Run(planner_.To(arm_.state().q, X_WT, speed_m_s), nullptr);
}

MoveResult SimRobot::MoveUntilContact(const Eigen::Isometry3d& X_WT, double speed_m_s,
                                      double force_N) {
  RequirePositive(speed_m_s, "MoveUntilContact: speed_m_s");
  RequirePositive(force_N, "MoveUntilContact: force_N");
  if (!X_WT.matrix().allFinite()) return {MoveEnd::kUnreachable, ToolPose()};
  std::optional<Trajectory> line = planner_.LineWithTolerance(arm_.state().q, X_WT, speed_m_s);
  if (!line) return {MoveEnd::kUnreachable, ToolPose()};
  Guard guard;
  guard.direction_W = X_WT.translation() - ToolPose().translation();
  if (guard.direction_W.norm() > 1e-6)
    guard.direction_W.normalize();
  else
    guard.direction_W.setZero();
  // What the arm carries already weighs on it: only the change counts.
  guard.force_at_start_W =
      sensors_.MeanForce(arm_.state(), environment_.ForceOnTool(), kReadingsAtRest);
  guard.force_N = force_N;
  return Run(Motion{std::move(*line)}, &guard);
}

MoveResult SimRobot::MoveToWaitingPose() {
  return Run(planner_.ToWaiting(arm_.state().q), nullptr);
}

double SimRobot::MoveGripper(double opening_m, double speed_m_s, double force_N) {
  RequirePositive(speed_m_s, "MoveGripper: speed_m_s");
  RequirePositive(force_N, "MoveGripper: force_N");
  if (!arm_model_.has_gripper() || !std::isfinite(opening_m)) return opening_m_;
  const RobotConfig& config = arm_model_.config();
  const double target_m = std::clamp(opening_m, 0.0, max_opening_m());
  const double grip_N = std::clamp(force_N, config.grip_force_min_N, config.grip_force_max_N);
  // Both fingers move, so the opening changes at twice their speed.
  const double change_m =
      2 * environment_.step_s() *
      std::clamp(speed_m_s, config.finger_speed_min_m_s, config.finger_speed_max_m_s);
  if (target_m > opening_m_) {
    if (holding_) environment_.EndHold();
    holding_ = false;
    while (opening_m_ < target_m) {
      opening_m_ = std::min(opening_m_ + change_m, target_m);
      StepWorld(false);
    }
    return opening_m_;
  }
  const auto pressing = [&] {
    return environment_.PadForce() >= grip_N || environment_.PadsBlocked();
  };
  bool stopped = holding_ && pressing();
  while (!stopped && opening_m_ > target_m) {
    opening_m_ = std::max(opening_m_ - change_m, target_m);
    StepWorld(false);
    stopped = pressing();
  }
  if (stopped || opening_m_ <= kClosedOpening_m) {
    environment_.BeginHold(grip_N);
    holding_ = true;
  }
  return opening_m_;
}

void SimRobot::Wait(double seconds) {
  const long steps = std::isfinite(seconds) ? std::lround(seconds / environment_.step_s()) : 0;
  for (long i = 0; i < steps; ++i) StepWorld(true);
}

RobotReading SimRobot::Read() {
  const Eigen::Vector3d force_W = environment_.ForceOnTool();
  RobotReading reading;
  reading.q_rad = arm_.state().q;
  reading.torque_Nm = sensors_.Torques(arm_.state(), force_W);
  reading.X_WT = ToolPose();
  reading.tool_force_N = sensors_.MeanForce(arm_.state(), force_W, kReadingsAtRest).norm();
  reading.gripper_opening_m = opening_m_;
  return reading;
}

bool SimRobot::Reachable(const Eigen::Isometry3d& X_WT) {
  return planner_.Reach(X_WT, arm_model_.posture()).has_value();
}

SimRobotState SimRobot::Save() const { return {arm_.state().q, opening_m_, holding_}; }

void SimRobot::Restore(const SimRobotState& state) {
  arm_.Place(state.q);
  opening_m_ = state.opening_m;
  holding_ = state.holding;
  arm_model_.LinkPoses(state.q, opening_m_, X_WL_);
}

}  // namespace gusset
