#include "agents/primitives/pick_place.h"

#include <algorithm>

namespace gusset {

void PickPlace(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
               const Eigen::Vector3d& place_W, const PickPlaceConfig& config,
               const MotionConfig& motion) {
  const auto cube = [&](double z) { return Eigen::Vector3d(cube_W.x(), cube_W.y(), z); };
  const auto place = [&](double z) { return Eigen::Vector3d(place_W.x(), place_W.y(), z); };

  // tau_pick. Never below 5 mm: the fingertips would press on the table.
  tool.OpenFingers();
  tool.Approach(cube(cube_W.z() + motion.approach_m), yaw_rad);
  tool.Go(cube(std::max(0.005, cube_W.z() - config.below_centre_m)), motion.descend_speed_m_s);
  const bool held = tool.Fingers(0) > config.held_opening_m;
  tool.Go(cube(config.carry_height_m), motion.descend_speed_m_s);
  if (!held) throw ToolMotion::Aborted("pick: nothing between the fingers");

  // mu_place.
  tool.Go(place(config.carry_height_m), motion.travel_speed_m_s);
  tool.Go(place(config.release_height_m), config.lower_speed_m_s);
  tool.Fingers(config.release_opening_m);
  tool.Go(place(config.carry_height_m), config.rise_speed_m_s);
}

}  // namespace gusset
