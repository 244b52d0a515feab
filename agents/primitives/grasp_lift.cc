#include "agents/primitives/grasp_lift.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace gusset {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
// Closer to the centre than this, a grasp point has no side of its own; pulled towards the base.
constexpr double kCentral_m = 0.01;
constexpr double kClosing_rad = 0;  // the fingers close along world x
constexpr double kNear_m = 0.03;    // guarded moves begin this far above the table

// With what is held at from_W up, over to high_W, and down to to_W; lets go.
void Stroke(ToolMotion& tool, const Vector3d& from_W, const Vector3d& high_W, const Vector3d& to_W,
            const GraspLiftConfig& config, const MotionConfig& motion) {
  tool.Go(At(from_W, std::min(high_W.z(), motion.approach_m)), config.lift_speed_m_s);
  LayDown(tool, high_W, to_W, kClosing_rad, config.release_opening_m, config);
}

// Finds the bag's edge by feel: tries from outside inwards until something is between the fingers.
// Returns where. `way`: the way out from the table's middle.
Vector3d SeizeEdge(ToolMotion& tool, const Vector3d& way, const Press& press,
                   const GraspLiftConfig& config, const MotionConfig& motion) {
  const auto at = [&](int probe) {
    const double from = std::min(config.probe_from_m, config.reach_m);
    return Vector3d(way * std::max(0.0, from - probe * config.probe_step_m));
  };
  tool.Fingers(config.opening_m);
  tool.Approach(At(at(0), config.rise_m), kClosing_rad);
  for (int probe = 0;; ++probe) {
    tool.Go(At(at(probe), kNear_m), motion.descend_speed_m_s);
    if (probe + 1 == config.probes) {
      tool.Seize(At(at(probe), 0), config.opening_m, press);
      return at(probe);
    }
    tool.GoUntilContact(At(at(probe), 0), press);
    if (tool.Close()) return at(probe);
    tool.Fingers(config.opening_m);
    tool.Go(At(at(probe), kNear_m), motion.descend_speed_m_s);
  }
}

}  // namespace

void LayDown(ToolMotion& tool, const Vector3d& high_W, const Vector3d& to_W, double closing_rad,
             double opening_m, const GraspLiftConfig& config) {
  const double height = high_W.z();
  const double tilt = height > config.tilt_above_m ? config.tilt_deg * kDegree : 0;
  tool.GoTilted(high_W, closing_rad, tilt, config.lift_speed_m_s);
  tool.GoTilted(At(0.5 * (high_W + to_W), 0.6 * height), closing_rad, 0.5 * tilt,
                config.lay_speed_m_s);
  tool.GoTilted(At(to_W, config.release_height_m), closing_rad, 0, config.lay_speed_m_s);
  tool.Fingers(opening_m);
  tool.Go(At(to_W, config.rise_m), config.rise_speed_m_s);
}

void GraspLift(ToolMotion& tool, const Vector3d& p_W, const Vector3d& centre_W, int parameter,
               const GraspLiftConfig& config, const MotionConfig& motion,
               const std::function<bool()>& is_unfolded) {
  Vector3d along = At(p_W - centre_W, 0);
  along = along.norm() > kCentral_m ? Vector3d(along.normalized()) : Vector3d(-Vector3d::UnitY());
  const Vector3d grasp = InReach(config.reach_m, p_W, centre_W);
  const Vector3d left = LeftOf(along);
  const Vector3d side = parameter % 2 == 1 ? left : Vector3d(-left);
  const Press press{config.touch_speed_m_s, config.contact_force_N, config.retries,
                    config.press_factor};

  // tau_grasp. A crumpled bag may stand higher than the approach.
  tool.Fingers(config.opening_m);
  tool.Approach(At(grasp, std::max(motion.approach_m, grasp.z() + kNear_m)), kClosing_rad);
  tool.Go(At(grasp, grasp.z() + 0.01), motion.descend_speed_m_s);
  tool.Seize(At(grasp, 0), config.opening_m, press);

  // mu_lift: hang the bag, lay it along its way, ...
  const Vector3d high = Within(config.reach_m, -along * config.trail_m);
  const Vector3d laid = Within(config.reach_m, along * config.lay_m);
  Stroke(tool, grasp, At(high, config.lift_height_m(parameter)), laid, config, motion);

  // ... and pull it flat by its edge: to either side, back and forth, ...
  std::vector<Vector3d> ways = {side, -side, -along, along};
  // ... and, while it is not seen to be unfolded, along the diagonals.
  const bool looks = config.looks && is_unfolded;
  if (looks) {
    for (const Vector3d& way : {Vector3d(side + along), Vector3d(side - along)}) {
      ways.push_back(way.normalized());
      ways.push_back(-way.normalized());
    }
  }
  for (const Vector3d& way : ways) {
    if (looks && is_unfolded()) return;
    const Vector3d from = SeizeEdge(tool, way, press, config, motion);
    const Vector3d to = Within(config.reach_m, from + way * config.pull_m);
    Stroke(tool, from, At(0.5 * (from + to), config.pull_height_m), to, config, motion);
  }
}

}  // namespace gusset
