#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "agents/ports/robot_port.h"
#include "sim/robot/arm.h"
#include "sim/robot/arm_environment.h"
#include "sim/robot/arm_model.h"
#include "sim/robot/arm_sensors.h"
#include "sim/robot/motion_planner.h"

namespace gusset {

/// All that an arm at rest carries from one action to the next.
struct SimRobotState {
  JointVector q;
  double opening_m = 0;
  bool holding = false;  ///< The environment was told BeginHold and not yet EndHold.
};

/// RobotPort on a simulated arm that moves in an ArmEnvironment, one environment step at a time.
/// Starts at rest in the waiting configuration with the gripper open. `arm` and `environment` must
/// outlive it.
class SimRobot : public RobotPort {
 public:
  SimRobot(const ArmModel& arm, ArmEnvironment& environment, std::uint64_t sensor_seed);

  MoveResult MoveTo(const Eigen::Isometry3d& X_WT, double speed_m_s) override;
  MoveResult MoveUntilContact(const Eigen::Isometry3d& X_WT, double speed_m_s,
                              double force_N) override;
  MoveResult MoveToWaitingPose() override;
  /// Speed and force are brought into the gripper's own range (config) first.
  double MoveGripper(double opening_m, double speed_m_s, double force_N) override;
  void Wait(double seconds) override;
  RobotReading Read() override;
  double max_opening_m() const override { return arm_model_.max_opening_m(); }

  /// True if MoveTo's tolerances leave a configuration for X_WT, clear of the camera.
  bool Reachable(const Eigen::Isometry3d& X_WT);
  /// To be called at rest, between RobotPort's calls.
  SimRobotState Save() const;
  /// Puts the arm back. Tells the environment nothing: it restores its own hold.
  void Restore(const SimRobotState& state);
  void SeedSensors(std::uint64_t seed) { sensors_.Seed(seed); }
  /// Poses of all links and the pads' distance as last told to the environment.
  const std::vector<Eigen::Isometry3d>& X_WL() const { return X_WL_; }
  double opening_m() const { return opening_m_; }

 private:
  /// What ends a guarded move: a force change against `direction_W` (any direction if zero).
  struct Guard {
    Eigen::Vector3d direction_W;
    Eigen::Vector3d force_at_start_W;
    double force_N;
  };
  MoveResult Run(const std::optional<Motion>& motion, const Guard* guard);
  std::optional<MoveEnd> Watch(const Guard* guard);
  void StepWorld(bool at_rest);
  Eigen::Isometry3d ToolPose() const { return arm_model_.ToolPose(arm_.state().q); }

  const ArmModel& arm_model_;
  ArmEnvironment& environment_;
  MotionPlanner planner_;
  ArmSensors sensors_;
  Arm arm_;
  std::vector<Eigen::Isometry3d> X_WL_;
  std::deque<Eigen::Vector3d> forces_W_;  // the last few estimates
  double force_bound_N_ = 0;              // of the motion under way
  double opening_m_;
  bool holding_ = false;
};

}  // namespace gusset
