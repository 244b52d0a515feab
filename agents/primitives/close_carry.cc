#include "agents/primitives/close_carry.h"

#include <algorithm>
#include <numbers>

namespace gusset {

void CloseCarry(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
                const CloseCarryConfig& config, const MotionConfig& motion) {
  const auto over = [&](double z) { return Eigen::Vector3d(p_W.x(), p_W.y(), z); };

  tool.Fingers(config.opening_m);
  const double closing = AngleOf(closing_W);
  tool.Approach(over(std::max(motion.approach_m, p_W.z() + 0.03)), closing);
  tool.GoUntilContact(over(config.height_m), config.contact_force_N);
  tool.Fingers(0);
  tool.Go(over(config.upright_m), config.lift_speed_m_s);
  Eigen::Vector3d high = over(0);
  if (high.norm() > config.column_m) high *= config.column_m / high.norm();
  high.z() = config.lift_height_m;
  tool.GoTilted(high, closing, config.tilt_deg * std::numbers::pi / 180, config.lift_speed_m_s);
}

}  // namespace gusset
