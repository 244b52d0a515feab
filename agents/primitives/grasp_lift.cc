#include "agents/primitives/grasp_lift.h"

#include <algorithm>
#include <numbers>

namespace gusset {
namespace {

// Closer to the centre than this, a grasp point has no side of its own; pulled towards the base.
constexpr double kCentral_m = 0.01;

Eigen::Vector3d At(const Eigen::Vector3d& p, double z) { return {p.x(), p.y(), z}; }

}  // namespace

void GraspLift(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& centre_W,
               int parameter, const GraspLiftConfig& config, const MotionConfig& motion) {
  const double degree = std::numbers::pi / 180;
  const double closing = config.closing_deg * degree;

  // tau_grasp. A crumpled bag may stand higher than the approach.
  tool.Fingers(config.opening_m);
  tool.Approach(At(p_W, std::max(motion.approach_m, p_W.z() + 0.03)), closing);
  tool.Go(At(p_W, p_W.z() + 0.01), motion.descend_speed_m_s);
  tool.GoUntilContact(At(p_W, std::max(0.0, p_W.z() - config.bite_m)), config.contact_force_N);
  tool.Fingers(0);

  // mu_lift: up, outwards, down.
  Eigen::Vector3d outwards = At(p_W - centre_W, 0);
  outwards = outwards.norm() > kCentral_m ? Eigen::Vector3d(outwards.normalized())
                                          : Eigen::Vector3d(-Eigen::Vector3d::UnitY());
  Eigen::Vector3d target = At(centre_W, 0) + outwards * config.pull_m;
  if (target.norm() > config.reach_m) target *= config.reach_m / target.norm();
  const double height = config.lift_height_m(parameter);
  const double tilt = height > config.tilt_above_m ? config.tilt_deg * degree : 0;
  tool.Go(At(p_W, std::min(height, motion.approach_m)), config.lift_speed_m_s);
  tool.GoTilted(At(0.5 * (p_W + centre_W), height), closing, tilt, config.lift_speed_m_s);
  tool.Wait(config.hang_s);
  tool.GoTilted(At(0.5 * (centre_W + target), 0.6 * height), closing, 0.5 * tilt,
                config.lay_speed_m_s);
  tool.GoTilted(At(target, config.release_height_m), closing, 0, config.lay_speed_m_s);
  tool.OpenFingers();
  tool.Go(At(target, config.release_height_m + motion.approach_m), config.rise_speed_m_s);
}

}  // namespace gusset
