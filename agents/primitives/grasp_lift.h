#pragma once

#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_grasp and mu_lift, the pair of s0. Section [primitives.grasp_lift]. Heights are those of the
/// fingertips above the table; all tuned, 2026-11, on folded starts of Bag 1.
struct GraspLiftConfig {
  double opening_m = 0.045;      ///< Fingers go down half open.
  double bite_m = 0.03;          ///< The fingertips go this far below the surface seen.
  double contact_force_N = 1.5;  ///< Felt earlier: close there.
  double closing_deg = 0;        ///< Direction in which the fingers close, from world x.
  double lift_speed_m_s = 0.25;
  double lift_low_m = 0.04;   ///< Height for parameter 0 ...
  double lift_step_m = 0.04;  ///< ... and from one parameter to the next.
  double hang_s = 0.3;        ///< The bag hangs there for so long, and unfolds under its weight.
  double tilt_deg = -29;      ///< Of the gripper above tilt_above_m (29 in the authors' code);
                              ///< < 0: the wrist leans away from the base.
  double tilt_above_m = 0.22;
  double pull_m = 0.34;    ///< From the bag's centre outwards, past the grasp point ...
  double reach_m = 0.245;  ///< ... but no further than this from the table's middle.
  double lay_speed_m_s = 0.25;
  double release_height_m = 0.008;
  double rise_speed_m_s = 0.10;  ///< Away from the cloth, without pulling it along.

  double lift_height_m(int parameter) const { return lift_low_m + parameter * lift_step_m; }

  template <class V>
  void Fields(V& v) {
    v("opening_m", opening_m, Range{0.01, 0.085});
    v("bite_m", bite_m, Range{0, 0.05});
    v("contact_force_N", contact_force_N, Range{0.5, 40});
    v("closing_deg", closing_deg, Range{-180, 180});
    v("lift_speed_m_s", lift_speed_m_s, Range{0.01, 1});
    v("lift_low_m", lift_low_m, Range{0.02, 0.3});
    v("lift_step_m", lift_step_m, Range{0, 0.04});
    v("hang_s", hang_s, Range{0, 10});
    v("tilt_deg", tilt_deg, Range{-40, 40});
    v("tilt_above_m", tilt_above_m, Range{0.05, 0.5});
    v("pull_m", pull_m, Range{0, 0.4});
    v("reach_m", reach_m, Range{0.05, 0.25});
    v("lay_speed_m_s", lay_speed_m_s, Range{0.01, 1});
    v("release_height_m", release_height_m, Range{0.005, 0.3});
    v("rise_speed_m_s", rise_speed_m_s, Range{0.01, 1});
  }
};

/// Grasps the bag at p_W, lifts it to lift_height_m(parameter), parameter 0 to 8, pulls it
/// outwards, away from the bag's centre, and lays it down there: low, plies are drawn apart over
/// the table, which holds the others; high, the bag hangs, unfolds under its weight and is laid
/// out.
/// @param centre_W the bag's centre as seen.
void GraspLift(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& centre_W,
               int parameter, const GraspLiftConfig& config, const MotionConfig& motion);

}  // namespace gusset
