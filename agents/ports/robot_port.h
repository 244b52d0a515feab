#pragma once

#include <Eigen/Geometry>

namespace gusset {

/// How a motion ended.
enum class MoveEnd {
  kReached,         ///< The target was reached.
  kContact,         ///< A guarded move felt its force and stopped there.
  kProtectiveStop,  ///< Torque or force beyond the arm's limits; the arm stopped where it was.
  kUnreachable,     ///< No joint solution; the arm did not move.
};

struct MoveResult {
  MoveEnd end = MoveEnd::kReached;
  Eigen::Isometry3d X_WT;  ///< Tool pose where the motion ended.
};

/// What the arm's own sensors say.
struct RobotReading {
  Eigen::VectorXd q_rad;      ///< Joint angles.
  Eigen::VectorXd torque_Nm;  ///< Joint torques, with the sensors' noise.
  Eigen::Isometry3d X_WT;     ///< Tool pose by forward kinematics.
  double tool_force_N = 0;    ///< Magnitude of the external force estimated from the torques.
  double gripper_opening_m = 0;
};

/// An arm with a parallel gripper over a table. Calls return when the motion has ended; simulated
/// (or real) time passes meanwhile. Tool frame T: origin midway between the fingertips' lower ends,
/// z the approach direction (out of the gripper), x the axis along which the fingers close.
class RobotPort {
 public:
  virtual ~RobotPort() = default;
  /// Straight line of the tool to X_WT at no more than speed_m_s, within all joint limits (slower
  /// where they demand it). Orientation is interpolated along. Tolerances: the gripper may arrive
  /// turned by half a turn about its approach axis, which exchanges its fingers; and where the arm
  /// has no way to X_WT as asked, it may tilt the tool by up to 30 degrees more about its tip, in
  /// the vertical plane through the arm's base. Where there is no straight line, the arm goes
  /// another way: straight up, across with the tool at 0.12 m above the table or higher, straight
  /// down. Only a goal at 0.075 m or higher above which nothing is reachable is come to on a slant.
  virtual MoveResult MoveTo(const Eigen::Isometry3d& X_WT, double speed_m_s) = 0;
  /// As MoveTo, but on a straight line only, and stops when the force estimated along the motion
  /// has changed by more than force_N since its start.
  virtual MoveResult MoveUntilContact(const Eigen::Isometry3d& X_WT, double speed_m_s,
                                      double force_N) = 0;
  /// Joint motion to the configuration in which the arm waits outside the camera's view.
  virtual MoveResult MoveToWaitingPose() = 0;
  /// Moves the fingers to opening_m (0: closed) at no more than speed_m_s per finger; stops when
  /// the pads press on something with force_N. @returns the opening reached.
  virtual double MoveGripper(double opening_m, double speed_m_s, double force_N) = 0;
  /// Lets time pass.
  virtual void Wait(double seconds) = 0;
  virtual RobotReading Read() = 0;
  /// Widest opening of the gripper.
  virtual double max_opening_m() const = 0;
};

}  // namespace gusset
