#include "agents/primitives/tool_motion.h"

#include <cmath>
#include <numbers>

namespace gusset {
namespace {

// Pads nearer than this hold nothing: a third of a ply of Bag 1; a ply below 0.4 mm would go
// unnoticed. The gripper itself reads this.
constexpr double kEmpty_m = 0.0004;
// Fingers whose line rises by no more than this are level: 1.7 mm at their widest, a layer or so.
constexpr double kLevel = 0.02;

const char* Named(MoveEnd end) {
  switch (end) {
    case MoveEnd::kReached:
      return "reached";
    case MoveEnd::kContact:
      return "contact";
    case MoveEnd::kProtectiveStop:
      return "protective stop";
    case MoveEnd::kUnreachable:
      return "unreachable";
  }
  return "";
}

std::string SecondTry(MoveEnd end) {
  return std::string("waiting pose at second try: ") + Named(end);
}

Eigen::Isometry3d Pose(const Eigen::Matrix3d& R_WT, const Eigen::Vector3d& p_W) {
  Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();
  X_WT.linear() = R_WT;
  X_WT.translation() = p_W;
  return X_WT;
}

}  // namespace

Eigen::Matrix3d DownwardTool(double closing_rad) {
  return (Eigen::AngleAxisd(closing_rad, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

double AngleOf(const Eigen::Vector3d& direction_W) {
  return std::atan2(direction_W.y(), direction_W.x());
}

Eigen::Vector3d At(const Eigen::Vector3d& p, double z) { return {p.x(), p.y(), z}; }

Eigen::Vector3d LeftOf(const Eigen::Vector3d& v) { return {-v.y(), v.x(), 0}; }

Eigen::Vector3d Within(double most_m, const Eigen::Vector3d& v) {
  return v.norm() > most_m ? Eigen::Vector3d(v * (most_m / v.norm())) : v;
}

Eigen::Vector3d InReach(double reach_m, const Eigen::Vector3d& p_W,
                        const Eigen::Vector3d& inside_W) {
  const Eigen::Vector3d from = At(inside_W, 0);
  const Eigen::Vector3d way = At(p_W, 0) - from;
  if (At(p_W, 0).norm() <= reach_m) return p_W;
  if (way.norm() == 0) return At(Within(reach_m, from), p_W.z());
  // |from + t way|^2 = reach_m^2; no such t if the line passes the disc: then where it comes
  // nearest.
  const double half_b = from.dot(way) / way.squaredNorm();
  const double c = (from.squaredNorm() - reach_m * reach_m) / way.squaredNorm();
  const double t = std::clamp(-half_b + std::sqrt(std::max(0.0, half_b * half_b - c)), 0.0, 1.0);
  return At(Within(reach_m, from + t * way), p_W.z());
}

void ToolMotion::Finish(const MoveResult& result, const char* what) {
  R_WT_ = result.X_WT.linear();
  if (result.end == MoveEnd::kReached || result.end == MoveEnd::kContact) return;
  throw Aborted(std::string(what) + ": " + Named(result.end));
}

Eigen::Vector3d ToolMotion::OutFromBase(const Eigen::Vector3d& p_W) const {
  return {p_W.x() - config_.base_x_m, p_W.y() - config_.base_y_m, 0};
}

void ToolMotion::Approach(const Eigen::Vector3d& p_W, double closing_rad) {
  Finish(robot_.MoveTo(Pose(DownwardTool(closing_rad), p_W), config_.travel_speed_m_s), "approach");
}

void ToolMotion::ApproachLevel(const Eigen::Vector3d& p_W, double closing_rad) {
  Approach(p_W, closing_rad);
  if (std::abs(R_WT_(2, 0)) <= kLevel) return;
  const double across_rad = AngleOf(LeftOf(OutFromBase(p_W)));
  const MoveResult turned =
      robot_.MoveTo(Pose(DownwardTool(across_rad), p_W), config_.travel_speed_m_s);
  // Then it has not moved: better askew than not at all.
  if (turned.end != MoveEnd::kUnreachable) Finish(turned, "approach");
}

void ToolMotion::Go(const Eigen::Vector3d& p_W, double speed_m_s) {
  Finish(robot_.MoveTo(Pose(R_WT_, p_W), speed_m_s), "move");
}

void ToolMotion::GoTilted(const Eigen::Vector3d& p_W, double closing_rad, double tilt_rad,
                          double speed_m_s) {
  // Turning the downward z axis about up x outward sends the fingertips outward when negative.
  const Eigen::Vector3d axis = LeftOf(OutFromBase(p_W)).normalized();
  const Eigen::Matrix3d tilt = Eigen::AngleAxisd(-tilt_rad, axis).toRotationMatrix();
  Finish(robot_.MoveTo(Pose(tilt * DownwardTool(closing_rad), p_W), speed_m_s), "tilted move");
}

Eigen::Vector3d ToolMotion::GoUntilContact(const Eigen::Vector3d& p_W, const Press& press) {
  const MoveResult result =
      robot_.MoveUntilContact(Pose(R_WT_, p_W), press.speed_m_s, press.force_N);
  Finish(result, "guarded move");
  return result.X_WT.translation();
}

Eigen::Vector3d ToolMotion::Seize(const Eigen::Vector3d& lowest_W, double opening_m, Press press) {
  for (int retry = 0;; ++retry) {
    const Eigen::Vector3d touched_W = GoUntilContact(lowest_W, press);
    if (Close() || retry == press.retries) return touched_W;
    Fingers(opening_m);
    press.force_N *= press.factor;
  }
}

bool ToolMotion::Close() {
  Fingers(0);
  return Holds();
}

bool ToolMotion::Holds() const { return opening_m_ > kEmpty_m; }

double ToolMotion::Fingers(double opening_m) {
  opening_m_ = robot_.MoveGripper(opening_m, config_.finger_speed_m_s, config_.grip_force_N);
  return opening_m_;
}

void ToolMotion::GoToWaitingPose() { Finish(robot_.MoveToWaitingPose(), "waiting pose"); }

std::optional<MoveEnd> ToolMotion::Leave() {
  if (robot_.MoveToWaitingPose().end == MoveEnd::kReached) return std::nullopt;
  // Whatever it holds or hangs on stopped it: let go and try once more.
  LetGoAndRise();
  return robot_.MoveToWaitingPose().end;
}

void ToolMotion::LeaveTheView() {
  const std::optional<MoveEnd> again = Leave();
  if (again.value_or(MoveEnd::kReached) != MoveEnd::kReached) throw Aborted(SecondTry(*again));
  Wait(config_.settle_s);
}

void ToolMotion::LetGoAndRise() {
  OpenFingers();
  const Eigen::Isometry3d X_WT = robot_.Read().X_WT;
  if (X_WT.translation().z() >= config_.approach_m) return;
  // Wherever this ends, the way home is tried from there.
  robot_.MoveTo(Pose(X_WT.linear(), At(X_WT.translation(), config_.approach_m)),
                config_.descend_speed_m_s);
}

std::string PerformAndLeave(RobotPort& robot, const MotionConfig& config,
                            const std::function<void(ToolMotion&)>& action) {
  ToolMotion tool(robot, config);
  try {
    action(tool);
  } catch (const ToolMotion::Aborted& aborted) {
    tool.Note(aborted.what());
    tool.LetGoAndRise();
  }
  if (const std::optional<MoveEnd> again = tool.Leave()) tool.Note(SecondTry(*again));
  robot.Wait(config.settle_s);
  return tool.note();
}

}  // namespace gusset
