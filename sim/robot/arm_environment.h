#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace gusset {

/// What the arm moves in: the world advances while the arm does, and pushes back. World implements
/// this; tests of the arm implement it with empty air or a wall.
class ArmEnvironment {
 public:
  virtual ~ArmEnvironment() = default;
  /// Fixed time step (s) of the world.
  virtual double step_s() const = 0;
  /// Advances by step_s(). X_WL: pose of every link of the robot at the step's end, in the robot
  /// model's order. finger_opening_m: distance between the pads' faces at the step's end.
  /// at_rest: no joint or finger moves during this step.
  virtual void Step(const std::vector<Eigen::Isometry3d>& X_WL, double finger_opening_m,
                    bool at_rest) = 0;
  /// Force (N, world frame) that the world put on gripper and fingers, averaged over the last 20 ms
  /// or so, weight of what is held included.
  virtual Eigen::Vector3d ForceOnTool() const = 0;
  /// Force with which both pads press on something between them (N): the smaller of the two sides.
  virtual double PadForce() const = 0;
  /// True if something rigid or cloth between the pads keeps them from closing further.
  virtual bool PadsBlocked() const = 0;
  /// The fingers have stopped on something or closed: what is between the pads is held from now on.
  virtual void BeginHold(double force_N) = 0;
  /// The fingers start to open.
  virtual void EndHold() = 0;
};

}  // namespace gusset
