#include "sim/robot/motion_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "sim/robot/tool_pose.h"

namespace gusset {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kLineStep_m = 0.010;
constexpr double kLineStep_rad = 3 * kDegree;
constexpr double kJointStep_rad = 3 * kDegree;
constexpr int kLeastSteps = 4;             // a spline needs some knots; tuned
constexpr double kLargestJump_rad = 0.25;  // of a joint between samples of a line; tuned
constexpr double kTiltStep_rad = 2.5 * kDegree;
constexpr double kDip = 0.8;       // of free_height_m: what joint-space moves keep; tuned
constexpr double kLowEntry = 0.5;  // of free_height_m: where a slanting line may end; tuned
constexpr double kSlack = 1e-6;    // rounding of m and rad against bounds met exactly

Eigen::Isometry3d Between(const Eigen::Isometry3d& X0, const Eigen::Isometry3d& X1, double x) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  X.translation() = (1 - x) * X0.translation() + x * X1.translation();
  X.linear() =
      Eigen::Quaterniond(X0.linear()).slerp(x, Eigen::Quaterniond(X1.linear())).toRotationMatrix();
  return X;
}

double Angle(const Eigen::Isometry3d& X0, const Eigen::Isometry3d& X1) {
  return Eigen::Quaterniond(X0.linear()).angularDistance(Eigen::Quaterniond(X1.linear()));
}

}  // namespace

MotionPlanner::MotionPlanner(const ArmModel& arm) : arm_(arm), ik_(arm) {}

// Every bound is relaxed to what the start already violates, so that an arm that was left in a bad
// place can move away, but never deeper.
std::optional<Trajectory> MotionPlanner::Timed(const std::vector<JointVector>& joints,
                                               double speed_m_s, double floor_m) const {
  const RobotConfig& config = arm_.config();
  const JointVector lower = arm_.limits().lower.cwiseMin(joints.front());
  const JointVector upper = arm_.limits().upper.cwiseMax(joints.front());
  const Eigen::Vector3d p_WB = arm_.X_WB().translation();
  double keep_out_m = config.base_keep_out_m;
  double clearance_m = config.camera_clearance_m;
  std::vector<Eigen::Vector3d> tool_m;
  for (const JointVector& q : joints) {
    const Eigen::Vector3d p_WT = arm_.ToolPose(q).translation();
    const double from_base_m = (p_WT - p_WB).head<2>().norm();
    const double from_camera_m = arm_.CameraClearance(q);
    if (tool_m.empty()) {
      keep_out_m = std::min(keep_out_m, from_base_m);
      clearance_m = std::min(clearance_m, from_camera_m);
      floor_m = std::min(floor_m, p_WT.z());
    }
    tool_m.push_back(p_WT);
    if (((q - lower).array() < -kSlack).any() || ((upper - q).array() < -kSlack).any() ||
        from_base_m < keep_out_m - kSlack || from_camera_m < clearance_m - kSlack ||
        p_WT.z() < floor_m - kSlack) {
      return std::nullopt;
    }
  }
  return Trajectory(joints, tool_m, arm_.limits(),
                    {.tool_speed_m_s = speed_m_s,
                     .tool_acceleration_m_s2 = config.tool_acceleration_m_s2,
                     .acceleration_share = config.acceleration_share});
}

// Spares following a line that passes through the base.
bool MotionPlanner::CrossesBase(const Eigen::Vector3d& p_W0, const Eigen::Vector3d& p_W1) const {
  const Eigen::Vector2d start = (p_W0 - arm_.X_WB().translation()).head<2>();
  const Eigen::Vector2d way = (p_W1 - p_W0).head<2>();
  if (way.isZero()) return false;
  const double nearest = std::clamp(-start.dot(way) / way.squaredNorm(), 0.0, 1.0);
  const double keep_out_m = std::min(arm_.config().base_keep_out_m, start.norm());
  return (start + nearest * way).norm() < keep_out_m - kSlack;
}

std::optional<Trajectory> MotionPlanner::Line(const JointVector& q, const Eigen::Isometry3d& X_WT,
                                              double speed_m_s) {
  const Eigen::Isometry3d X_WStart = arm_.ToolPose(q);
  const double length_m = (X_WT.translation() - X_WStart.translation()).norm();
  const double turn_rad = Angle(X_WStart, X_WT);
  if (CrossesBase(X_WStart.translation(), X_WT.translation())) return std::nullopt;
  const int steps = std::max({kLeastSteps, static_cast<int>(std::ceil(length_m / kLineStep_m)),
                              static_cast<int>(std::ceil(turn_rad / kLineStep_rad))});
  std::vector<JointVector> joints{q};
  const JointVector lower = arm_.limits().lower.cwiseMin(q);
  const JointVector upper = arm_.limits().upper.cwiseMax(q);
  for (int k = 1; k <= steps; ++k) {
    const std::optional<JointVector> next =
        ik_.Track(Between(X_WStart, X_WT, static_cast<double>(k) / steps), joints.back());
    if (!next || (*next - joints.back()).cwiseAbs().maxCoeff() > kLargestJump_rad ||
        (*next - lower).minCoeff() < 0 || (upper - *next).minCoeff() < 0) {
      return std::nullopt;
    }
    joints.push_back(*next);
  }
  return Timed(joints, speed_m_s, -std::numeric_limits<double>::infinity());
}

std::optional<Trajectory> MotionPlanner::Joints(const JointVector& q, const JointVector& q_end,
                                                double speed_m_s, double floor_m) const {
  const double largest = (q_end - q).cwiseAbs().maxCoeff();
  const int steps = std::max(kLeastSteps, static_cast<int>(std::ceil(largest / kJointStep_rad)));
  std::vector<JointVector> joints;
  for (int k = 0; k <= steps; ++k) {
    const double x = static_cast<double>(k) / steps;
    joints.push_back((1 - x) * q + x * q_end);
  }
  return Timed(joints, speed_m_s, std::min(floor_m, arm_.ToolPose(q_end).translation().z()));
}

std::vector<Eigen::Isometry3d> MotionPlanner::Variants(const Eigen::Isometry3d& X_WT,
                                                       const Eigen::Isometry3d& X_WTool) const {
  std::vector<Eigen::Isometry3d> variants;
  const auto append = [&](double tilt_rad) {
    const Eigen::Isometry3d X = TiltRadially(X_WT, arm_.X_WB().translation(), tilt_rad);
    const Eigen::Isometry3d flipped = Flipped(X);
    const bool as_asked = !arm_.has_gripper() || Angle(X_WTool, X) <= Angle(X_WTool, flipped);
    variants.push_back(as_asked ? X : flipped);
    if (arm_.has_gripper()) variants.push_back(as_asked ? flipped : X);
  };
  append(0);
  const double max_tilt_rad = arm_.config().max_tilt_deg * kDegree;
  for (double tilt = kTiltStep_rad; tilt <= max_tilt_rad + kSlack; tilt += kTiltStep_rad) {
    append(-tilt);
    append(tilt);
  }
  return variants;
}

std::optional<JointVector> MotionPlanner::Reach(const Eigen::Isometry3d& X_WT,
                                                const JointVector& near) {
  const std::vector<Eigen::Isometry3d> variants = Variants(X_WT, arm_.ToolPose(near));
  // Two seeds settle nearly every case; the restarts are for the rest.
  for (const int restarts : {0, 20}) {
    for (const Eigen::Isometry3d& X :
         std::span(variants).first(restarts == 0 ? variants.size() : upright_variants())) {
      const std::optional<JointVector> q = ik_.Solve(X, near, restarts);
      if (q && arm_.CameraClearance(*q) >= arm_.config().camera_clearance_m) return q;
    }
  }
  return std::nullopt;
}

std::optional<Trajectory> MotionPlanner::LineWithTolerance(const JointVector& q,
                                                           const Eigen::Isometry3d& X_WT,
                                                           double speed_m_s) {
  for (const Eigen::Isometry3d& X : Variants(X_WT, arm_.ToolPose(q))) {
    if (std::optional<Trajectory> line = Line(q, X, speed_m_s)) return line;
  }
  return std::nullopt;
}

std::optional<Motion> MotionPlanner::To(const JointVector& q, const Eigen::Isometry3d& X_WT,
                                        double speed_m_s) {
  const Eigen::Isometry3d X_WStart = arm_.ToolPose(q);
  const bool starts_free = X_WStart.translation().z() >= arm_.config().free_height_m;
  if (starts_free) {
    const std::vector<Eigen::Isometry3d> variants = Variants(X_WT, X_WStart);
    for (const Eigen::Isometry3d& X : std::span(variants).first(upright_variants())) {
      if (std::optional<Trajectory> line = Line(q, X, speed_m_s)) return Motion{std::move(*line)};
    }
    if (std::optional<Motion> detour = Detour(q, X_WT, speed_m_s)) return detour;
  }
  if (std::optional<Trajectory> line = LineWithTolerance(q, X_WT, speed_m_s)) {
    return Motion{std::move(*line)};
  }
  if (starts_free) return std::nullopt;
  return Detour(q, X_WT, speed_m_s);
}

// Between two poses that are both free: through joint space, or by the gate.
std::optional<Motion> MotionPlanner::Across(const JointVector& q, const Eigen::Isometry3d& X_WT,
                                            double speed_m_s) {
  const double floor_m = kDip * arm_.config().free_height_m;
  const std::vector<Eigen::Isometry3d> variants = Variants(X_WT, arm_.ToolPose(q));
  const auto direct = [&](std::span<const Eigen::Isometry3d> goals) -> std::optional<Motion> {
    for (const Eigen::Isometry3d& X : goals) {
      // Near the gate means over the table, which keeps the arm from bending over backwards.
      const std::optional<JointVector> end = ik_.Solve(X, arm_.gate(), 0);
      if (!end) continue;
      if (auto joints = Joints(q, *end, speed_m_s, floor_m)) return Motion{std::move(*joints)};
    }
    return std::nullopt;
  };
  if (auto upright = direct(std::span(variants).first(upright_variants()))) return upright;
  if (auto in = Joints(q, arm_.gate(), speed_m_s, floor_m)) {
    if (auto on = LineWithTolerance(arm_.gate(), X_WT, speed_m_s)) {
      return Motion{std::move(*in), std::move(*on)};
    }
  }
  return direct(std::span(variants).subspan(upright_variants()));
}

std::optional<Motion> MotionPlanner::Detour(const JointVector& q, const Eigen::Isometry3d& X_WT,
                                            double speed_m_s) {
  const double free_m = arm_.config().free_height_m;
  Motion motion;
  Eigen::Isometry3d X_WAbove = arm_.ToolPose(q);
  if (X_WAbove.translation().z() < free_m) {
    X_WAbove.translation().z() = free_m;
    auto up = LineWithTolerance(q, X_WAbove, speed_m_s);
    if (!up) return std::nullopt;
    motion.push_back(std::move(*up));
  }
  const JointVector& at = motion.empty() ? q : motion.back().end();
  const double height_m = X_WT.translation().z();
  X_WAbove = X_WT;
  X_WAbove.translation().z() = std::max(height_m, free_m);
  auto across = Across(at, X_WAbove, speed_m_s);
  // Close to the base the arm may reach the goal but no place above it.
  const bool slanting = !across && height_m >= kLowEntry * free_m;
  if (slanting) across = Across(at, X_WT, speed_m_s);
  if (!across) return std::nullopt;
  motion.insert(motion.end(), across->begin(), across->end());
  if (height_m < free_m && !slanting) {
    auto down = LineWithTolerance(motion.back().end(), X_WT, speed_m_s);
    if (!down) return std::nullopt;
    motion.push_back(std::move(*down));
  }
  return motion;
}

// From where the fingertips may go down no further, by the ways tried in turn.
std::optional<Motion> MotionPlanner::Home(const JointVector& q, double floor_m) {
  const double speed_m_s = arm_.config().travel_speed_m_s;
  if (auto direct = Joints(q, arm_.waiting(), speed_m_s, floor_m)) return Motion{*direct};
  auto aside = LineWithTolerance(q, arm_.ToolPose(arm_.gate()), speed_m_s);
  if (!aside) aside = Joints(q, arm_.gate(), speed_m_s, floor_m);
  if (!aside) return std::nullopt;
  auto home = Joints(aside->end(), arm_.waiting(), speed_m_s, floor_m);
  if (!home) return std::nullopt;
  return Motion{std::move(*aside), std::move(*home)};
}

std::optional<Motion> MotionPlanner::ToWaiting(const JointVector& q) {
  if (auto home = Home(q, arm_.ToolPose(q).translation().z())) return home;
  const Eigen::Isometry3d X_WT = arm_.ToolPose(q);
  Eigen::Vector3d outward = X_WT.translation() - arm_.X_WB().translation();
  outward.z() = 0;
  outward.normalize();
  // Near the base the arm is folded as far as it goes and cannot rise: there it has to move out.
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const Eigen::Vector3d& first_m :
       {Eigen::Vector3d(0.05 * up), Eigen::Vector3d(0.10 * up), Eigen::Vector3d(0.20 * up),
        Eigen::Vector3d(0.30 * up), Eigen::Vector3d(0.10 * outward),
        Eigen::Vector3d(0.20 * outward)}) {
    Eigen::Isometry3d X_WFirst = X_WT;
    X_WFirst.translation() += first_m;
    auto first = LineWithTolerance(q, X_WFirst, arm_.config().travel_speed_m_s);
    if (!first) continue;
    if (auto home = Home(first->end(), X_WT.translation().z())) {
      home->insert(home->begin(), std::move(*first));
      return home;
    }
  }
  return std::nullopt;
}

}  // namespace gusset
