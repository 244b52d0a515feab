#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "sim/robot/robot_config.h"
#include "sim/robot/robot_model.h"

namespace gusset {

/// Joint vectors of the arm; the bound keeps them off the heap.
inline constexpr int kMaxArmJoints = 12;
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxArmJoints, 1>;
using ToolJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxArmJoints>;

/// Limits of the arm's joints, one entry per joint from the base outwards; rad, s, N m.
struct ArmLimits {
  JointVector lower, upper;  ///< Position, less the config's margin.
  JointVector velocity;
  JointVector acceleration;
  JointVector torque;
};

/// A robot model standing in the world, of which one chain of joints is the arm and two sliding
/// joints may be fingers. Joints that are neither stay at zero. Immutable; threads may share it.
class ArmModel {
 public:
  /// @param assets  folder that the config's paths are relative to.
  /// @throws InputError naming file and element if the config does not fit the URDF.
  static ArmModel Load(const RobotConfig& config, const std::filesystem::path& assets,
                       bool with_visuals = true);

  const RobotModel& robot() const { return robot_; }
  const RobotConfig& config() const { return config_; }
  const ArmLimits& limits() const { return limits_; }
  int num_joints() const { return static_cast<int>(chain_moving_.size()); }
  /// Joints (indices of robot().joints()) from base to tip: those that move, and all of them.
  const std::vector<int>& moving_joints() const { return chain_moving_; }
  const std::vector<int>& chain_joints() const { return chain_; }
  bool has_gripper() const { return finger_a_ >= 0; }
  int finger_link_a() const { return robot_.joints()[finger_a_].child; }
  int finger_link_b() const { return robot_.joints()[finger_b_].child; }
  double max_opening_m() const { return max_opening_m_; }
  const Eigen::Isometry3d& X_WB() const { return X_WB_; }  ///< Pose of the base link.
  const JointVector& waiting() const { return waiting_; }
  const JointVector& gate() const { return gate_; }
  const JointVector& posture() const { return posture_; }
  const JointVector& posture_weight() const { return posture_weight_; }

  /// Poses of all links, in the model's order. ~1 us.
  void LinkPoses(const JointVector& q, double opening_m,
                 std::vector<Eigen::Isometry3d>& X_WL) const;
  Eigen::Isometry3d ToolPose(const JointVector& q) const;
  /// Pose and Jacobian of the tool: linear velocity of T's origin above angular velocity, world
  /// axes.
  void ToolJacobianAt(const JointVector& q, Eigen::Isometry3d& X_WT, ToolJacobian& J) const;
  /// True if q keeps the position limits (margin included).
  bool WithinLimits(const JointVector& q) const;
  /// Distance (m) between the config's camera body and the nearest link; fingers wide open.
  double CameraClearance(const JointVector& q) const;

 private:
  ArmModel(RobotModel robot, const RobotConfig& config, const std::filesystem::path& limits_file);
  void FindChain();
  void FindFingers();
  void ReadLimits(const std::filesystem::path& limits_file);

  RobotModel robot_;
  RobotConfig config_;
  std::vector<int> chain_, chain_moving_;
  std::vector<double> reach_m_;  // per link: radius about its origin that its collisions stay in
  std::vector<int> arm_index_;   // per joint of the robot: its place in q, or -1
  int finger_a_ = -1, finger_b_ = -1;
  double max_opening_m_ = 0;
  ArmLimits limits_;
  Eigen::Isometry3d X_WB_, X_WRoot_;
  JointVector waiting_, gate_, posture_, posture_weight_;
};

}  // namespace gusset
