#include "agents/primitives/pick_place.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace gusset {
namespace {

bool IsNarrow(const Mouth::Width& width, const PickPlaceConfig& config) {
  return width.radius_m < config.room_m;
}

// Draws one side of a mouth away from the other: the one that lies farther from the rim, for that
// is the layer on top. Along the body it lies where it is drawn to; a lip that is drawn back from
// the rim becomes a flap and springs back, unless it is drawn as far as an opening is
// (ScratchDrag). A lip that lies nearer its rim than halfway there is no flap yet: it has slid back
// flat, and what it slid does not count.
void Widen(ToolMotion& tool, const Mouth& mouth, const PickPlaceConfig& config,
           const ScratchDragConfig& scratch, const MotionConfig& motion) {
  const auto& [a_W, b_W] = mouth.width->sides_W;
  const Eigen::Vector3d apart = At(b_W - a_W, 0);
  const bool b_is_inner = apart.dot(mouth.rim_outward_W) < 0;
  const Eigen::Vector3d way = (b_is_inner ? 1 : -1) * apart.normalized();
  const double back_rad = std::acos(std::clamp(-way.dot(mouth.rim_outward_W), -1.0, 1.0));
  const double flap_m = apart.norm() < 0.5 * scratch.drag_m ? 0 : apart.norm();
  const double drawn_m = back_rad < config.back_deg * std::numbers::pi / 180
                             ? std::max(config.widen_m, scratch.drag_m - flap_m)
                             : config.widen_m;
  ScratchDragConfig low = scratch;
  low.lift_m = config.widen_lift_m;
  low.asides = 0;  // two layers at once widen it, too
  DrawLayer(tool, (b_is_inner ? b_W : a_W) + config.grasp_inset_m * way, drawn_m * way, LeftOf(way),
            low, motion);
}

// Lays the bag flat by its near lip, from which it hangs as it is sewn.
void LayFlat(const Mouth& mouth, const PickPlaceConfig& config, const Unfold& unfold) {
  constexpr int kMiddle = 4;  // of GraspLift's parameters; which one hardly matters here
  unfold(mouth.near_W - config.grasp_inset_m * mouth.Outward_W(), mouth.drawn_W, kMiddle);
}

// tau_pick. @returns the height at which the cube is grasped.
double Pick(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
            const PickPlaceConfig& config, const MotionConfig& motion) {
  // Never below 5 mm: the fingertips would press on the table.
  const double held_z = std::max(0.005, cube_W.z() - config.below_centre_m);
  tool.OpenFingers();
  tool.Approach(At(cube_W, cube_W.z() + motion.approach_m), yaw_rad);
  tool.Go(At(cube_W, held_z), motion.descend_speed_m_s);
  const bool held = tool.Fingers(0) > config.held_opening_m;
  tool.Go(At(cube_W, config.carry_height_m), motion.descend_speed_m_s);
  if (!held) throw ToolMotion::Aborted("pick: nothing between the fingers");
  return held_z;
}

}  // namespace

bool TakesTheCube(const std::optional<Mouth>& mouth, const PickPlaceConfig& config) {
  if (!mouth || !mouth->width) return true;
  return mouth->width->closed && !IsNarrow(*mouth->width, config);
}

void MendMouth(ToolMotion& tool, const Mouth& mouth, const PickPlaceConfig& config,
               const Unfold& unfold, const ScratchDragConfig& scratch, const MotionConfig& motion) {
  if (IsNarrow(*mouth.width, config) && mouth.width->length_m >= config.slit_m) {
    tool.Note("mouth widened");
    return Widen(tool, mouth, config, scratch, motion);
  }
  tool.Note("bag laid flat");
  LayFlat(mouth, config, unfold);
}

void PickPlace(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
               const Eigen::Vector3d& place_W, const std::optional<Mouth>& mouth,
               const PickPlaceConfig& config, const MotionConfig& motion) {
  const double held_z = Pick(tool, cube_W, yaw_rad, config, motion);

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

bool SetAside(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
              const Eigen::Vector3d& bag_W, const PickPlaceConfig& config,
              const MotionConfig& motion) {
  const Eigen::Vector3d yaw_W(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  const Eigen::Vector3d from_bag = At(cube_W - bag_W, 0);
  const bool faces_it = std::abs(yaw_W.dot(from_bag)) > std::abs(LeftOf(yaw_W).dot(from_bag));
  const Eigen::Vector3d aside_W(config.aside_m[0], config.aside_m[1], 0);
  try {
    const double held_z =
        Pick(tool, cube_W, AngleOf(faces_it ? LeftOf(yaw_W) : yaw_W), config, motion);
    tool.GoTilted(At(aside_W, config.carry_height_m), 0, 0, motion.travel_speed_m_s);
    tool.GoUntilContact(At(aside_W, held_z), config.slide_force_N);
    tool.Fingers(config.release_opening_m);
    tool.Note("cube set aside");
    tool.Go(At(aside_W, config.carry_height_m), config.rise_speed_m_s);
    return true;
  } catch (const ToolMotion::Aborted& aborted) {
    tool.LetGoAndRise();
    tool.Note(std::string("cube not set aside: ") + aborted.what());
    return false;
  }
}

}  // namespace gusset
