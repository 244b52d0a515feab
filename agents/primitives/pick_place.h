#pragma once

#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_pick and mu_place, the pair of s2. Section [primitives.pick_place]. Heights are those of the
/// fingertips; all tuned.
struct PickPlaceConfig {
  double below_centre_m = 0.006;     ///< Fingertips this far below the cube's centre.
  double held_opening_m = 0.015;     ///< Fingers that close further than this hold nothing.
  double carry_height_m = 0.12;      ///< Over everything on the table.
  double release_height_m = 0.04;    ///< Above the place point's table height.
  double release_opening_m = 0.055;  ///< Enough for a 35 mm cube, without reaching the cloth.
  double lower_speed_m_s = 0.10;
  double rise_speed_m_s = 0.10;

  template <class V>
  void Fields(V& v) {
    v("below_centre_m", below_centre_m, Range{-0.02, 0.03});
    v("held_opening_m", held_opening_m, Range{0, 0.08});
    v("carry_height_m", carry_height_m, Range{0.05, 0.3});
    v("release_height_m", release_height_m, Range{0.01, 0.3});
    v("release_opening_m", release_opening_m, Range{0.01, 0.085});
    v("lower_speed_m_s", lower_speed_m_s, Range{0.01, 1});
    v("rise_speed_m_s", rise_speed_m_s, Range{0.01, 1});
  }
};

/// Picks the cube up and lets go of it above place_W.
/// @param cube_W  centre of the cube. @param yaw_rad  of one of its edges about z.
void PickPlace(ToolMotion& tool, const Eigen::Vector3d& cube_W, double yaw_rad,
               const Eigen::Vector3d& place_W, const PickPlaceConfig& config,
               const MotionConfig& motion);

}  // namespace gusset
