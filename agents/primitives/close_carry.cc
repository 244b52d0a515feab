#include "agents/primitives/close_carry.h"

#include <algorithm>

namespace gusset {

void CloseCarry(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
                const CloseCarryConfig& config, const MotionConfig& motion) {
  const auto over = [&](double z) { return Eigen::Vector3d(p_W.x(), p_W.y(), z); };

  tool.Fingers(config.opening_m);
  tool.Approach(over(std::max(motion.approach_m, p_W.z() + 0.03)), AngleOf(closing_W));
  tool.GoUntilContact(over(config.height_m), config.contact_force_N);
  tool.Fingers(0);
  tool.Go(over(config.lift_height_m), config.lift_speed_m_s);
}

}  // namespace gusset
