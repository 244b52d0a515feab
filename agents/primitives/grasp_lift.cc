#include "agents/primitives/grasp_lift.h"

#include <algorithm>
#include <numbers>

namespace gusset {

void GraspLift(ToolMotion& tool, const Eigen::Vector3d& p_W, int parameter,
               const GraspLiftConfig& config, const MotionConfig& motion) {
  const double degree = std::numbers::pi / 180;
  const double closing = config.closing_deg * degree;
  const auto over = [&](double z) { return Eigen::Vector3d(p_W.x(), p_W.y(), z); };

  // tau_grasp: down to the table, gather, close. A crumpled bag may stand higher than the approach.
  tool.Fingers(config.gather_opening_m);
  tool.Approach(over(std::max(motion.approach_m, p_W.z() + 0.03)), closing);
  tool.GoUntilContact(over(-0.005), motion.contact_force_N);
  for (int i = 0; i < config.gather_cycles; ++i) {
    tool.Fingers(config.gather_closing_m);
    tool.Fingers(config.gather_opening_m);
  }
  tool.Fingers(0);

  // mu_lift: up, hang, lay down while moving, let go.
  tool.Go(over(motion.approach_m), config.lift_speed_m_s);
  const double tilt = config.tilt_deg * degree;
  tool.GoTilted({0, config.lay_start_m, config.hang_height_m}, closing, tilt,
                config.lift_speed_m_s);
  tool.Wait(config.hang_s);
  const double height = config.release_height_m(parameter);
  tool.GoTilted({0, config.lay_end_m, height}, closing, tilt, config.lay_speed_m_s);
  tool.OpenFingers();
  tool.Go({0, config.lay_end_m, height + motion.approach_m}, config.rise_speed_m_s);
}

}  // namespace gusset
