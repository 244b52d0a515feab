#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

#include "agents/ports/robot_port.h"
#include "base/config.h"

namespace gusset {

/// Settings that all primitives share. Section [primitives]. Speeds are those of a real arm at work
/// beside people (KUKA and Robotiq allow more); all tuned.
struct MotionConfig {
  double travel_speed_m_s = 0.40;   ///< Free motion.
  double descend_speed_m_s = 0.15;  ///< Down to where a guarded move begins.
  double guarded_speed_m_s = 0.02;  ///< Until contact; GraspLift has its own.
  double finger_speed_m_s = 0.10;   ///< Per finger; the real gripper does 0.02 to 0.15.
  double grip_force_N = 60;         ///< Of the closed gripper; the real one does 20 to 235.
  double approach_m = 0.10;         ///< Fingertips above the table before and after an action.
  double settle_s = 2;              ///< Waiting time in the waiting pose, before the look.
  double base_x_m = 0;              ///< Where the arm stands: a tool tilts in the vertical plane
  double base_y_m = -0.44;          ///< through this point.

  template <class V>
  void Fields(V& v) {
    v("travel_speed_m_s", travel_speed_m_s, Range{0.01, 1});
    v("descend_speed_m_s", descend_speed_m_s, Range{0.01, 1});
    v("guarded_speed_m_s", guarded_speed_m_s, Range{0.002, 0.25});
    v("finger_speed_m_s", finger_speed_m_s, Range{0.02, 0.15});
    v("grip_force_N", grip_force_N, Range{20, 235});
    v("approach_m", approach_m, Range{0.04, 0.3});
    v("settle_s", settle_s, Range{0, 10});
    v("base_x_m", base_x_m, Range{-2, 2});
    v("base_y_m", base_y_m, Range{-2, 2});
  }
};

/// Rotation of a tool that points straight down, its fingers closing along the world's x axis
/// turned by closing_rad about z.
Eigen::Matrix3d DownwardTool(double closing_rad);

/// Angle about z of a horizontal direction, for DownwardTool.
double AngleOf(const Eigen::Vector3d& direction_W);

/// The point above or below p at height z.
Eigen::Vector3d At(const Eigen::Vector3d& p, double z);
/// Horizontal, as long as v is seen from above, and a quarter turn to its left.
Eigen::Vector3d LeftOf(const Eigen::Vector3d& v);
/// v, shortened to most_m if it is longer.
Eigen::Vector3d Within(double most_m, const Eigen::Vector3d& v);
/// p_W or, if it is farther than reach_m from the table's middle, the point at its height that is
/// nearest it on the way to it from inside_W and no farther than that.
Eigen::Vector3d InReach(double reach_m, const Eigen::Vector3d& p_W,
                        const Eigen::Vector3d& inside_W);

/// How a grasp comes down, and how hard it presses on what it grasps.
struct Press {
  double speed_m_s = 0;
  double force_N = 0;
  int retries = 0;    ///< If the fingers close on nothing, so often again ...
  double factor = 1;  ///< ... each time so many times as hard.
};

/// A gripper at work. Motions that do not end as meant throw, so that a primitive reads as what it
/// does; the orientation that the arm settled on is kept from one motion to the next.
class ToolMotion {
 public:
  /// A motion did not end as meant; what() says which and how.
  struct Aborted : std::runtime_error {
    using std::runtime_error::runtime_error;
  };

  ToolMotion(RobotPort& robot, const MotionConfig& config) : robot_(robot), config_(config) {}

  /// Free motion to p_W, the tool straight down. The arm may exchange the fingers, which is the
  /// same grasp, and tilt the tool a little where it cannot reach otherwise.
  void Approach(const Eigen::Vector3d& p_W, double closing_rad);
  /// The same for a grasp of cloth. Where the arm cannot get there but by tilting the tool, as near
  /// its base, fingers that close along the tilt do not reach the table together: the lower one
  /// keeps the other off the cloth. There they close across the tilt if they can, however they were
  /// to. What the arm has to tilt on its further way is not looked at.
  void ApproachLevel(const Eigen::Vector3d& p_W, double closing_rad);
  /// Straight line to p_W, orientation kept.
  void Go(const Eigen::Vector3d& p_W, double speed_m_s);
  /// Straight line to p_W, the tool meanwhile turning to tilt_rad in the vertical plane through the
  /// arm's base (> 0: fingertips lean away from it) from straight down with this closing angle.
  void GoTilted(const Eigen::Vector3d& p_W, double closing_rad, double tilt_rad, double speed_m_s);
  /// Straight line to p_W at guarded_speed_m_s until force_N is felt. @returns where it ended.
  Eigen::Vector3d GoUntilContact(const Eigen::Vector3d& p_W, double force_N) {
    return GoUntilContact(p_W, Press{config_.guarded_speed_m_s, force_N});
  }
  /// The same at a grasp's speed and with its first force.
  Eigen::Vector3d GoUntilContact(const Eigen::Vector3d& p_W, const Press& press);
  /// Straight to lowest_W until the press is felt, then closes; while the pads stay empty, opens
  /// and tries again, harder. @returns where the fingers closed.
  Eigen::Vector3d Seize(const Eigen::Vector3d& lowest_W, double opening_m, Press press);
  /// Direction in which the fingers close now, as for DownwardTool.
  double closing_rad() const { return AngleOf(R_WT_.col(0)); }
  /// Closes the fingers. @returns whether something is between them.
  bool Close();
  /// Whether something was between the fingers when they last moved.
  bool Holds() const;
  /// Fingers to opening_m (0: closed). @returns the opening reached.
  double Fingers(double opening_m);
  /// The opening that the fingers last reached.
  double opening_m() const { return opening_m_; }
  /// As wide as they go. @returns the opening reached.
  double OpenFingers() { return Fingers(robot_.max_opening_m()); }
  void Wait(double seconds) { robot_.Wait(seconds); }
  /// To where the arm waits outside the camera's view.
  void GoToWaitingPose();
  /// The same; if something stops the arm it lets go, rises and tries once more. Never throws.
  /// @returns how the second try ended, if it took one.
  std::optional<MoveEnd> Leave();
  /// Leaves so in the middle of an action, for a look, and waits until things have settled.
  void LeaveTheView();
  /// What pulls or pushes at the tool now, N, as felt in the joints; at rest, the weight of what is
  /// held.
  double FeltForce() { return robot_.Read().tool_force_N; }
  /// For the log: what was done instead of what was meant, or before it, in a few words.
  void Note(const std::string& note) { note_ += (note_.empty() ? "" : "; ") + note; }
  const std::string& note() const { return note_; }
  /// Opens the fingers and goes straight up out of the cloth, as far as that works; never throws.
  void LetGoAndRise();

 private:
  void Finish(const MoveResult& result, const char* what);
  /// Horizontal, from the arm's base to p_W.
  Eigen::Vector3d OutFromBase(const Eigen::Vector3d& p_W) const;

  RobotPort& robot_;
  MotionConfig config_;
  std::string note_;
  double opening_m_ = 0;
  Eigen::Matrix3d R_WT_ = Eigen::Matrix3d::Identity();
};

/// Runs `action`, then leaves the camera's view and lets things settle. If the action is aborted
/// the gripper lets go and rises first. Never throws ToolMotion::Aborted.
/// @returns what happened that is worth a note, joined by "; ".
std::string PerformAndLeave(RobotPort& robot, const MotionConfig& config,
                            const std::function<void(ToolMotion&)>& action);

}  // namespace gusset
