#include "sim/robot/arm_model.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <sstream>
#include <utility>

#include "base/error.h"

namespace gusset {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kMostStroke_m = 0.5;  // of a finger; wider grippers do not stand beside a table

struct JointLimitsFile {
  std::vector<double> acceleration_rad_s2;
  template <class V>
  void Fields(V& v) {
    v("acceleration_rad_s2", acceleration_rad_s2, {0.01, 1000});
  }
};

JointVector ToJoints(const std::vector<double>& values, double scale, int n, const char* key) {
  if (static_cast<int>(values.size()) != n) {
    throw InputError(std::string("robot.") + key + " has " + std::to_string(values.size()) +
                     " values, the arm " + std::to_string(n) + " joints");
  }
  return scale * Eigen::Map<const Eigen::VectorXd>(values.data(), n);
}

}  // namespace

ArmModel ArmModel::Load(const RobotConfig& config, const std::filesystem::path& assets,
                        bool with_visuals) {
  ValidateOrThrow("robot", config);
  return ArmModel(RobotModel::Load(assets / config.urdf, with_visuals), config,
                  assets / config.joint_limits);
}

ArmModel::ArmModel(RobotModel robot, const RobotConfig& config,
                   const std::filesystem::path& limits_file)
    : robot_(std::move(robot)), config_(config) {
  if (config.base_m.size() != 3) throw InputError("robot.base_m is not three numbers");
  if (config.camera_m.size() != 3) throw InputError("robot.camera_m is not three numbers");
  if (config.finger_speed_min_m_s > config.finger_speed_max_m_s ||
      config.grip_force_min_N > config.grip_force_max_N) {
    throw InputError("robot: a gripper minimum is above its maximum");
  }
  X_WB_ = Eigen::Translation3d(config.base_m[0], config.base_m[1], config.base_m[2]) *
          Eigen::AngleAxisd(config.base_yaw_deg * kDegree, Eigen::Vector3d::UnitZ());
  for (const RobotLink& link : robot_.links()) {
    double reach_m = 0;
    for (const CollisionShape& shape : link.collisions) {
      reach_m = std::max(reach_m, shape.X_LS.translation().norm() + shape.size_m.norm());
    }
    reach_m_.push_back(reach_m);
  }
  FindChain();
  FindFingers();
  ReadLimits(limits_file);
  const int n = num_joints();
  waiting_ = ToJoints(config.waiting_deg, kDegree, n, "waiting_deg");
  gate_ = ToJoints(config.gate_deg, kDegree, n, "gate_deg");
  posture_ = ToJoints(config.posture_deg, kDegree, n, "posture_deg");
  posture_weight_ = ToJoints(config.posture_weight, 1, n, "posture_weight");
  for (const auto& [q, key] : {std::pair(&waiting_, "waiting_deg"), {&gate_, "gate_deg"}}) {
    if (WithinLimits(*q)) continue;
    throw InputError(std::string("robot.") + key + " is not within the joint limits of " +
                     robot_.file());
  }
}

void ArmModel::FindChain() {
  const auto link = [&](const std::string& name, const char* key) {
    const std::optional<int> index = robot_.FindLink(name);
    if (!index) {
      throw InputError(robot_.file() + ": robot." + key + " = '" + name + "' is not a link of it");
    }
    return *index;
  };
  const int base = link(config_.base_link, "base_link");
  int at = link(config_.tip_link, "tip_link");
  for (; at != base && at != 0; at = robot_.joints()[at - 1].parent) chain_.push_back(at - 1);
  if (at != base) {
    throw InputError(robot_.file() + ": robot.tip_link = '" + config_.tip_link +
                     "' does not hang on robot.base_link = '" + config_.base_link + "'");
  }
  std::ranges::reverse(chain_);
  arm_index_.assign(robot_.joints().size(), -1);
  for (const int j : chain_) {
    if (robot_.joints()[j].kind == RobotJoint::Kind::kFixed) continue;
    arm_index_[j] = num_joints();
    chain_moving_.push_back(j);
  }
  if (chain_moving_.empty() || num_joints() > kMaxArmJoints) {
    throw InputError(robot_.file() + ": between base and tip " + std::to_string(num_joints()) +
                     " joints move; it must be 1 to " + std::to_string(kMaxArmJoints));
  }
  X_WRoot_ = X_WB_;
  for (int l = base; l != 0; l = robot_.joints()[l - 1].parent) {
    const RobotJoint& joint = robot_.joints()[l - 1];
    if (joint.kind != RobotJoint::Kind::kFixed) {
      throw InputError(robot_.file() + ": joint '" + joint.name +
                       "' below robot.base_link is not fixed");
    }
    X_WRoot_ = X_WRoot_ * joint.X_PJ.inverse();
  }
}

void ArmModel::FindFingers() {
  if (config_.finger_joint_a.empty()) return;
  const auto finger = [&](const std::string& name, const char* key) {
    const std::optional<int> index = robot_.FindJoint(name);
    if (!index || robot_.joints()[*index].kind != RobotJoint::Kind::kPrismatic ||
        arm_index_[*index] >= 0) {
      throw InputError(robot_.file() + ": robot." + key + " = '" + name +
                       "' is not a sliding joint outside the arm");
    }
    return *index;
  };
  finger_a_ = finger(config_.finger_joint_a, "finger_joint_a");
  finger_b_ = finger(config_.finger_joint_b, "finger_joint_b");
  if (finger_a_ == finger_b_) {
    throw InputError(robot_.file() + ": robot.finger_joint_a and robot.finger_joint_b are both '" +
                     config_.finger_joint_a + "'");
  }
  for (const int j : {finger_a_, finger_b_}) {
    const RobotJoint& joint = robot_.joints()[j];
    if (joint.upper > 0 && joint.upper <= kMostStroke_m) continue;
    std::ostringstream what;
    what << robot_.file() << ": joint '" << joint.name << "': limit upper = " << joint.upper
         << " is not within (0, " << kMostStroke_m << "], as a finger's must be";
    throw InputError(what.str());
  }
  max_opening_m_ = 2 * std::min(robot_.joints()[finger_a_].upper, robot_.joints()[finger_b_].upper);
}

void ArmModel::ReadLimits(const std::filesystem::path& limits_file) {
  const int n = num_joints();
  JointLimitsFile file{std::vector<double>(n)};
  ConfigTree tree;
  tree.Load(limits_file);
  tree.Read("", file);
  tree.RefuseUnknown();
  limits_.acceleration = ToJoints(file.acceleration_rad_s2, 1, n, "joint_limits");
  if (limits_.acceleration.minCoeff() <= 0) {
    throw InputError(limits_file.string() + ": acceleration_rad_s2 is missing");
  }
  limits_.lower = limits_.upper = limits_.velocity = limits_.torque = JointVector::Zero(n);
  for (int i = 0; i < n; ++i) {
    const RobotJoint& joint = robot_.joints()[chain_moving_[i]];
    const bool turns = joint.kind == RobotJoint::Kind::kRevolute;
    const double margin = turns ? config_.limit_margin_deg * kDegree : 0;
    limits_.lower[i] = joint.lower + margin;
    limits_.upper[i] = joint.upper - margin;
    limits_.velocity[i] = joint.velocity;
    limits_.torque[i] = joint.effort;
  }
}

void ArmModel::LinkPoses(const JointVector& q, double opening_m,
                         std::vector<Eigen::Isometry3d>& X_WL) const {
  const std::vector<RobotJoint>& joints = robot_.joints();
  X_WL.resize(robot_.links().size());
  X_WL[0] = X_WRoot_;
  for (int j = 0; j < static_cast<int>(joints.size()); ++j) {
    double value = arm_index_[j] >= 0 ? q[arm_index_[j]] : 0.0;
    if (j == finger_a_ || j == finger_b_) value = 0.5 * opening_m;
    X_WL[joints[j].child] = X_WL[joints[j].parent] * joints[j].Transform(value);
  }
}

Eigen::Isometry3d ArmModel::ToolPose(const JointVector& q) const {
  Eigen::Isometry3d X = X_WB_;
  for (const int j : chain_) {
    X = X * robot_.joints()[j].Transform(arm_index_[j] >= 0 ? q[arm_index_[j]] : 0.0);
  }
  return X;
}

void ArmModel::ToolJacobianAt(const JointVector& q, Eigen::Isometry3d& X_WT,
                              ToolJacobian& J) const {
  J.resize(6, num_joints());
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxArmJoints> origins(3, num_joints());
  X_WT = X_WB_;
  for (const int j : chain_) {
    const RobotJoint& joint = robot_.joints()[j];
    const int i = arm_index_[j];
    X_WT = X_WT * joint.Transform(i >= 0 ? q[i] : 0.0);
    if (i < 0) continue;
    // The joint's axis is the same before and after it has turned about itself.
    J.col(i).tail<3>() = X_WT.linear() * joint.axis_J;
    origins.col(i) = X_WT.translation();
  }
  for (int i = 0; i < num_joints(); ++i) {
    const Eigen::Vector3d axis = J.col(i).tail<3>();
    if (robot_.joints()[chain_moving_[i]].kind == RobotJoint::Kind::kRevolute) {
      J.col(i).head<3>() = axis.cross(X_WT.translation() - origins.col(i));
    } else {
      J.col(i) << axis, Eigen::Vector3d::Zero();
    }
  }
}

bool ArmModel::WithinLimits(const JointVector& q) const {
  return (q.array() >= limits_.lower.array()).all() && (q.array() <= limits_.upper.array()).all();
}

double ArmModel::CameraClearance(const JointVector& q) const {
  thread_local std::vector<Eigen::Isometry3d> X_WL;
  LinkPoses(q, max_opening_m_, X_WL);
  // The body is a row of three balls along x.
  const Eigen::Vector3d centre(config_.camera_m[0], config_.camera_m[1], config_.camera_m[2]);
  const double half_m = std::max(config_.camera_half_length_m - config_.camera_radius_m, 0.0);
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t l = 0; l < X_WL.size(); ++l) {
    const std::vector<CollisionShape>& shapes = robot_.links()[l].collisions;
    const double far_m = (X_WL[l].translation() - centre).norm() - half_m - reach_m_[l];
    if (shapes.empty() || far_m >= nearest) continue;
    for (const double x : {-half_m, 0.0, half_m}) {
      const Eigen::Vector3d p_L = X_WL[l].inverse() * (centre + Eigen::Vector3d(x, 0, 0));
      for (const CollisionShape& shape : shapes) nearest = std::min(nearest, shape.Distance(p_L));
    }
  }
  return nearest - config_.camera_radius_m;
}

}  // namespace gusset
