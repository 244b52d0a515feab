#pragma once

#include <optional>
#include <vector>

#include "agents/primitives/grasp_lift.h"
#include "agents/primitives/mouth.h"
#include "agents/primitives/scratch_drag.h"
#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_pick and mu_place, the pair of s2. Section [primitives.pick_place]. Heights are those of the
/// fingertips; all tuned.
struct PickPlaceConfig {
  double room_m = 0.031;          ///< A mouth without room for a disc of this radius loses half
                                  ///< of the cubes put into it, so it is widened first:
  double slit_m = 0.2;            ///< one that is at least so long, two thirds of the rim, by ...
  double widen_m = 0.05;          ///< ... drawing one side so far from the other ...
  double back_deg = 37;           ///< (as far as an opening, if within this of straight back) ...
  double widen_lift_m = 0.03;     ///< ... raised by so much, ...
  double grasp_inset_m = 0.008;   ///< ... grasped so far from its edge. Of a shorter one the rim is
                                  ///< folded: the bag is laid flat, to be opened anew.
  int mends = 3;                  ///< So often in one action at most; after each it looks.
  double below_centre_m = 0.006;  ///< Fingertips this far below the cube's centre.
  double held_opening_m = 0.015;  ///< Fingers that close further than this hold nothing.
  double carry_height_m = 0.12;   ///< Over everything on the table.
  double lip_inset_m = 0.022;     ///< The cube comes down so far inside the mouth's near lip ...
  double slide_height_m = 0.006;  ///< ... and slides to its place so much above where it was
                                  ///< grasped ...
  double slide_force_N = 10;      ///< ... or until it meets this.
  double release_opening_m = 0.055;  ///< Enough for a 35 mm cube, without reaching the cloth.
  double lower_speed_m_s = 0.10;
  double rise_speed_m_s = 0.10;
  std::vector<double> aside_m = {0.42, 0};  ///< Where a cube is put that is in the bag's way.

  template <class V>
  void Fields(V& v) {
    v("room_m", room_m, Range{0, 0.1});
    v("slit_m", slit_m, Range{0, 1});
    v("widen_m", widen_m, Range{0, 0.3});
    v("back_deg", back_deg, Range{0, 90});
    v("widen_lift_m", widen_lift_m, Range{0.01, 0.25});
    v("grasp_inset_m", grasp_inset_m, Range{0, 0.05});
    v("mends", mends, Range{1, 10});
    v("below_centre_m", below_centre_m, Range{-0.02, 0.03});
    v("held_opening_m", held_opening_m, Range{0, 0.08});
    v("carry_height_m", carry_height_m, Range{0.05, 0.3});
    v("lip_inset_m", lip_inset_m, Range{0, 0.1});
    v("slide_height_m", slide_height_m, Range{0, 0.1});
    v("slide_force_N", slide_force_N, Range{0.5, 50});
    v("release_opening_m", release_opening_m, Range{0.01, 0.085});
    v("lower_speed_m_s", lower_speed_m_s, Range{0.01, 1});
    v("rise_speed_m_s", rise_speed_m_s, Range{0.01, 1});
    v("aside_m", aside_m, Range{-0.6, 0.6});
  }
};

/// Whether the cube is placed in such a mouth, rather than the mouth mended; so it is where nothing
/// is known of its width.
bool TakesTheCube(const std::optional<Mouth>& mouth, const PickPlaceConfig& config);

/// Mends a mouth that does not take the cube: a long one is widened, a bag with a short one laid
/// flat. So is one whose mouth has room, if a single lip is all that is seen of it.
/// @param mouth its width is known. @param unfold lays the bag flat. @param scratch how a mouth is
/// widened.
void MendMouth(ToolMotion& tool, const Mouth& mouth, const PickPlaceConfig& config,
               const Unfold& unfold, const ScratchDragConfig& scratch, const MotionConfig& motion);

/// Picks the cube up, puts it down inside the mouth's near lip, slides it to place_W, under the
/// layer that was drawn back rather than onto it, and lets go.
/// @param cube_W  centre of the cube. @param yaw_rad  of one of its edges about z.
/// @param mouth  none if rim or lips are not seen: then the cube comes down at place_W.
void PickPlace(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
               const Eigen::Vector3d& place_W, const std::optional<Mouth>& mouth,
               const PickPlaceConfig& config, const MotionConfig& motion);

/// Picks up a cube that stands beside the bag, by the two sides that face the bag's middle least,
/// and puts it down at config.aside_m. Where that does not work it is let go of, and the arm rises.
/// Never throws ToolMotion::Aborted.
/// @param bag_W the bag's middle. @returns whether it worked.
bool SetAside(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
              const Eigen::Vector3d& bag_W, const PickPlaceConfig& config,
              const MotionConfig& motion);

}  // namespace gusset
