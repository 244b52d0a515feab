#include "agents/primitives/grasp_lift.h"

#include <algorithm>
#include <numbers>

namespace gusset {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
// Closer to the centre than this, a grasp point has no side of its own; pulled towards the base.
constexpr double kCentral_m = 0.01;
constexpr double kClosing_rad = 0;  // the fingers close along world x
constexpr double kNear_m = 0.03;    // guarded moves begin this far above the table

// Up at from_W, over to high_W, and down to to_W.
void Stroke(ToolMotion& tool, const Vector3d& from_W, const Vector3d& high_W, const Vector3d& to_W,
            double hang_s, const GraspLiftConfig& config, const MotionConfig& motion) {
  const double height = high_W.z();
  const double tilt = height > config.tilt_above_m ? config.tilt_deg * kDegree : 0;
  tool.Go(At(from_W, std::min(height, motion.approach_m)), config.lift_speed_m_s);
  tool.GoTilted(high_W, kClosing_rad, tilt, config.lift_speed_m_s);
  tool.Wait(hang_s);
  tool.GoTilted(At(0.5 * (high_W + to_W), 0.6 * height), kClosing_rad, 0.5 * tilt,
                config.lay_speed_m_s);
  tool.GoTilted(At(to_W, config.release_height_m), kClosing_rad, 0, config.lay_speed_m_s);
  tool.Fingers(config.release_opening_m);
  tool.Go(At(to_W, config.rise_m), config.rise_speed_m_s);
}

}  // namespace

void GraspLift(ToolMotion& tool, const Vector3d& p_W, const Vector3d& centre_W, int parameter,
               const GraspLiftConfig& config, const MotionConfig& motion) {
  Vector3d along = At(p_W - centre_W, 0);
  along = along.norm() > kCentral_m ? Vector3d(along.normalized()) : Vector3d(-Vector3d::UnitY());
  const Vector3d left(-along.y(), along.x(), 0);
  const Vector3d side = parameter % 2 == 1 ? left : Vector3d(-left);

  // tau_grasp. A crumpled bag may stand higher than the approach.
  tool.Fingers(config.opening_m);
  tool.Approach(At(p_W, std::max(motion.approach_m, p_W.z() + kNear_m)), kClosing_rad);
  tool.Go(At(p_W, p_W.z() + 0.01), motion.descend_speed_m_s);
  const Press press{config.contact_force_N, config.retries, config.press_factor};
  tool.Seize(At(p_W, 0), config.opening_m, press);

  // mu_lift, first stroke: hang the bag and lay it along its way.
  const Vector3d high = Within(config.reach_m, -along * config.trail_m);
  const Vector3d laid = Within(config.reach_m, along * config.lay_m);
  Stroke(tool, p_W, At(high, config.lift_height_m(parameter)), laid, config.hang_s, config, motion);

  // Second stroke: spread it across.
  const Vector3d edge = along * config.spread_along_m + side * config.spread_from_m;
  const Vector3d spread = Within(config.reach_m, edge + side * config.spread_m);
  tool.Fingers(config.opening_m);
  tool.Approach(At(edge, config.rise_m), kClosing_rad);
  tool.Go(At(edge, kNear_m), motion.descend_speed_m_s);
  tool.Seize(At(edge, 0), config.opening_m, press);
  Stroke(tool, edge, At(0.5 * (edge + spread), config.spread_height_m), spread, 0, config, motion);
}

}  // namespace gusset
