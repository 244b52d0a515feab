#include "agents/primitives/pick_place.h"

#include <algorithm>

namespace gusset {
namespace {

// An opening too small for the cube: a slit between lips that lie nearly on each other, which one
// of them drawn back widens, or a corner of the bag folded over, which is laid back.
void Mend(ToolMotion& tool, const Mouth& mouth, const PickPlaceConfig& config,
          const ScratchDragConfig& scratch, const MotionConfig& motion) {
  if (mouth.Apart_W().dot(mouth.rim_outward_W) < config.folded_m) {
    tool.Note("slit widened instead");
    const Eigen::Vector3d inward = -mouth.rim_outward_W;
    const Eigen::Vector3d grasp = mouth.drawn_W + config.grasp_inset_m * inward;
    DrawLayer(tool, grasp, config.widen_m * inward, LeftOf(inward), scratch, motion);
  } else {
    tool.Note("folded corner laid back instead");
    ScratchDragConfig both = scratch;
    both.asides = 0;  // it is the two layers that are to be grasped
    const Eigen::Vector3d outward = mouth.Outward_W();
    DrawLayer(tool, mouth.drawn_W + config.grasp_inset_m * outward,
              mouth.Apart_W() + config.over_m * outward, LeftOf(outward), both, motion);
  }
}

}  // namespace

void PickPlace(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
               const Eigen::Vector3d& place_W, const std::optional<Mouth>& mouth,
               const PickPlaceConfig& config, const ScratchDragConfig& scratch,
               const MotionConfig& motion) {
  if (mouth && mouth->area_m2 < config.room_m2) {
    return Mend(tool, *mouth, config, scratch, motion);
  }
  // Never below 5 mm: the fingertips would press on the table.
  const double held_z = std::max(0.005, cube_W.z() - config.below_centre_m);

  // tau_pick.
  tool.OpenFingers();
  tool.Approach(At(cube_W, cube_W.z() + motion.approach_m), yaw_rad);
  tool.Go(At(cube_W, held_z), motion.descend_speed_m_s);
  const bool held = tool.Fingers(0) > config.held_opening_m;
  tool.Go(At(cube_W, config.carry_height_m), motion.descend_speed_m_s);
  if (!held) throw ToolMotion::Aborted("pick: nothing between the fingers");

  // mu_place, the fingers beside the cube as it slides, so that the cube leads.
  Eigen::Vector3d down_W = place_W;
  double closing = yaw_rad;
  if (mouth && mouth->Apart_W().norm() > 0) {
    const Eigen::Vector3d outward = mouth->Outward_W();
    down_W += outward * std::max(0.0, (mouth->near_W - place_W).dot(outward) - config.lip_inset_m);
    closing = AngleOf(LeftOf(outward));
  }
  const double slide_z = held_z + config.slide_height_m;
  tool.GoTilted(At(down_W, config.carry_height_m), closing, 0, motion.travel_speed_m_s);
  tool.Go(At(down_W, slide_z), config.lower_speed_m_s);
  const Eigen::Vector3d placed_W = tool.GoUntilContact(At(place_W, slide_z), config.slide_force_N);
  tool.Fingers(config.release_opening_m);
  tool.Go(At(placed_W, config.carry_height_m), config.rise_speed_m_s);
}

}  // namespace gusset
