#pragma once

#include "agents/ports/referee.h"
#include "agents/ports/robot_port.h"

namespace gusset {

/// The robot, with someone watching: notes for the log how many layers the gripper truly holds each
/// time it has closed. Nothing of it reaches whoever moves the robot.
class Witness final : public RobotPort {
 public:
  Witness(RobotPort& robot, Referee& referee) : robot_(robot), referee_(referee) {}

  void Forget() { layers_held_ = 0; }
  /// After the last full closing since Forget.
  int layers_held() const { return layers_held_; }

  MoveResult MoveTo(const Eigen::Isometry3d& X_WT, double speed_m_s) override {
    return robot_.MoveTo(X_WT, speed_m_s);
  }
  MoveResult MoveUntilContact(const Eigen::Isometry3d& X_WT, double speed_m_s,
                              double force_N) override {
    return robot_.MoveUntilContact(X_WT, speed_m_s, force_N);
  }
  MoveResult MoveToWaitingPose() override { return robot_.MoveToWaitingPose(); }
  double MoveGripper(double opening_m, double speed_m_s, double force_N) override {
    const double reached = robot_.MoveGripper(opening_m, speed_m_s, force_N);
    if (opening_m == 0) layers_held_ = referee_.LayersHeld();
    return reached;
  }
  void Wait(double seconds) override { robot_.Wait(seconds); }
  RobotReading Read() override { return robot_.Read(); }
  double max_opening_m() const override { return robot_.max_opening_m(); }

 private:
  RobotPort& robot_;
  Referee& referee_;
  int layers_held_ = 0;
};

}  // namespace gusset
