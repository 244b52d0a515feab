#include "agents/primitives/close_carry.h"

#include <algorithm>
#include <numbers>

namespace gusset {
namespace {

// From the cube's middle to fingers that close beside it: half of it and of a pad (22 mm, 2F-85
// manual).
constexpr double kBesideCube_m = 0.03;

// A bag that is held far behind its mouth, or by a corner of it, tips over and loses what is in it.
Eigen::Vector3d AtTheRim(const Eigen::Vector3d& p_W, const Mouth& mouth,
                         const CloseCarryConfig& config) {
  const Eigen::Vector3d outward = mouth.Outward_W();
  const Eigen::Vector3d along = LeftOf(outward);
  const Eigen::Vector3d to_lip = At(mouth.near_W - p_W, 0);
  const double aside = to_lip.dot(along);
  return p_W + outward * std::max(0.0, to_lip.dot(outward) - config.rim_inset_m) +
         along * (aside - std::clamp(aside, -config.rim_aside_m, config.rim_aside_m));
}

bool AreApart(const Mouth& mouth, const CloseCarryConfig& config) {
  return mouth.Apart_W().norm() >= config.lips_apart_m;
}

// Brings the drawn lip to over where the bag is to be grasped.
void BringLip(ToolMotion& tool, const Mouth& mouth, const Eigen::Vector3d& grasp_W,
              const Eigen::Vector3d& closing_W, const CloseCarryConfig& config,
              const ScratchDragConfig& drag, const MotionConfig& motion) {
  const Eigen::Vector3d lip_W = mouth.drawn_W - config.lip_behind_m * mouth.Outward_W();
  const Eigen::Vector3d seized_W =
      SeizeLayer(tool, lip_W, grasp_W - lip_W, closing_W, drag, motion);
  BringLayer(tool, seized_W, grasp_W, drag);
}

// Where the bag is grasped that is to be grasped at p_W.
Eigen::Vector3d GraspPoint(const Eigen::Vector3d& p_W, const std::optional<Mouth>& mouth,
                           const Eigen::Vector3d& cube_W, const CloseCarryConfig& config,
                           const GraspLiftConfig& lift) {
  return InReach(lift.reach_m, mouth ? AtTheRim(p_W, *mouth, config) : p_W, cube_W);
}

// Closes on the bag at grasp_W or, where there is nothing to close on, nearer and nearer to the
// cube, but not on it: the same grasp would fail again and again. Returns where. The last is lifted
// in any case, for the fingers do not feel a film; the scales tell.
Eigen::Vector3d Grasp(ToolMotion& tool, const Eigen::Vector3d& grasp_W, double over_m,
                      const Eigen::Vector3d& cube_W, const CloseCarryConfig& config,
                      const GraspLiftConfig& lift, const MotionConfig& motion) {
  const Eigen::Vector3d way = At(cube_W - grasp_W, 0);
  const double most_m = std::max(0.0, way.norm() - kBesideCube_m);
  Eigen::Vector3d at_W = grasp_W;
  for (int retry = 0;; ++retry) {
    const double touched_m =
        tool.GoUntilContact(At(at_W, config.height_m), config.contact_force_N).z();
    const double nearer_m = std::min((retry + 1) * config.retry_step_m, most_m);
    const Eigen::Vector3d next_W = InReach(lift.reach_m, grasp_W + Within(nearer_m, way), grasp_W);
    if (tool.Close() || retry == config.retries || next_W == at_W) return at_W;
    if (retry == 0) tool.Note("closed anew");
    tool.Fingers(config.opening_m);
    const double high_m = std::max(over_m, touched_m);
    tool.Go(At(at_W, high_m), motion.descend_speed_m_s);
    tool.Go(At(next_W, high_m), motion.descend_speed_m_s);
    at_W = next_W;
  }
}

// Lays the bag out to the side of the table where the cube is not.
void LayDownAgain(ToolMotion& tool, const Eigen::Vector3d& cube_W, double closing,
                  const CloseCarryConfig& config, const GraspLiftConfig& lift) {
  const Eigen::Vector3d away = -At(cube_W, 0).normalized();
  LayDown(tool, At(-config.behind_m * away, config.lift_height_m), lift.reach_m * away, closing,
          config.opening_m, lift);
}

}  // namespace

bool LipFalls(const std::optional<Mouth>& mouth, const CloseCarryConfig& config) {
  return config.lip_release_m > 0 && mouth && AreApart(*mouth, config);
}

void DropLip(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
             const Mouth& mouth, const Eigen::Vector3d& cube_W, const CloseCarryConfig& config,
             const ScratchDragConfig& drag, const GraspLiftConfig& lift,
             const MotionConfig& motion) {
  const Eigen::Vector3d over_W = GraspPoint(p_W, mouth, cube_W, config, lift);
  ScratchDragConfig high = drag;
  high.release_height_m = config.lip_release_m;
  BringLip(tool, mouth, over_W, closing_W, config, high, motion);
  tool.Fingers(drag.release_opening_m);
  tool.Go(At(over_W, motion.approach_m), drag.rise_speed_m_s);
}

void CloseCarry(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
                const std::optional<Mouth>& mouth, const Eigen::Vector3d& cube_W,
                const CloseCarryConfig& config, const ScratchDragConfig& drag,
                const GraspLiftConfig& lift, const MotionConfig& motion) {
  Eigen::Vector3d grasp = GraspPoint(p_W, mouth, cube_W, config, lift);
  // The cloth may stand higher than the approach.
  const double over_m = std::max(motion.approach_m, p_W.z() + 0.03);

  // tau_close.
  if (mouth && AreApart(*mouth, config) && config.lip_release_m == 0) {
    // The fingers open to gather both lips, but do not rise from the upper one: it would spring
    // back.
    BringLip(tool, *mouth, grasp, closing_W, config, drag, motion);
    tool.GoUntilContact(At(grasp, config.height_m), config.contact_force_N);
    tool.Fingers(config.opening_m);
  } else {
    tool.Fingers(config.opening_m);
    tool.ApproachLevel(At(grasp, over_m), AngleOf(closing_W));
  }
  grasp = Grasp(tool, grasp, over_m, cube_W, config, lift, motion);

  // mu_carry, without turning what is held.
  const double closing = tool.closing_rad();
  tool.Go(At(grasp, config.upright_m), config.lift_speed_m_s);
  const Eigen::Vector3d high = At(Within(config.column_m, At(grasp, 0)), config.lift_height_m);
  tool.GoTilted(high, closing, config.tilt_deg * std::numbers::pi / 180, config.lift_speed_m_s);
  tool.GoToWaitingPose();

  // Weigh it: what is too light has lost the cube.
  tool.Wait(config.weigh_after_s);
  if (tool.FeltForce() >= config.filled_N) return;
  tool.Note("too light: laid down again");
  LayDownAgain(tool, cube_W, closing, config, lift);
}

}  // namespace gusset
