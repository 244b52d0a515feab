#pragma once

#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_grasp and mu_lift, the pair of s0. Section [primitives.grasp_lift]. Heights are those of the
/// fingertips above the table. The authors' cycles, tilt and release heights; the rest is tuned.
struct GraspLiftConfig {
  double gather_opening_m = 0.045;  ///< Fingers go down half open.
  double gather_closing_m = 0.012;  ///< Partly closing drags cloth together.
  int gather_cycles = 2;            ///< Partial closings before the full one.
  double closing_deg = 0;           ///< Direction in which the fingers close, from world x.
  double lift_speed_m_s = 0.25;
  double hang_height_m = 0.36;  ///< The bag hangs here; the highest over the centre.
  double hang_s = 0.6;          ///< ... for so long, and unfolds under its weight.
  /// Of the gripper while it lifts (29 in the authors' code); < 0: the wrist leans away from the
  /// base, without which the arm would fold too far over the centre.
  double tilt_deg = -29;
  double lay_start_m = -0.08;  ///< y over which it hangs.
  double lay_end_m = 0.08;     ///< y at which it is released: laid out towards +y.
  double lay_speed_m_s = 0.25;
  double release_low_m = 0.02;   ///< Height for parameter 0 ...
  double release_step_m = 0.03;  ///< ... and from one parameter to the next.
  double rise_speed_m_s = 0.10;  ///< Away from the cloth, without pulling it along.

  double release_height_m(int parameter) const {
    return release_low_m + parameter * release_step_m;
  }

  template <class V>
  void Fields(V& v) {
    v("gather_opening_m", gather_opening_m, Range{0.01, 0.085});
    v("gather_closing_m", gather_closing_m, Range{0, 0.085});
    v("gather_cycles", gather_cycles, Range{0, 10});
    v("closing_deg", closing_deg, Range{-180, 180});
    v("lift_speed_m_s", lift_speed_m_s, Range{0.01, 1});
    v("hang_height_m", hang_height_m, Range{0.1, 0.36});
    v("hang_s", hang_s, Range{0, 10});
    v("tilt_deg", tilt_deg, Range{-40, 40});
    v("lay_start_m", lay_start_m, Range{-0.25, 0.25});
    v("lay_end_m", lay_end_m, Range{-0.25, 0.25});
    v("lay_speed_m_s", lay_speed_m_s, Range{0.01, 1});
    v("release_low_m", release_low_m, Range{0.005, 0.3});
    v("release_step_m", release_step_m, Range{0, 0.04});
    v("rise_speed_m_s", rise_speed_m_s, Range{0.01, 1});
  }
};

/// Grasps the bag at p_W, lets it hang over the middle of the table, lays it down and lets go at
/// release_height_m(parameter), parameter 0 to 8: the lower, the more it is laid; the higher, the
/// more it is dropped.
void GraspLift(ToolMotion& tool, const Eigen::Vector3d& p_W, int parameter,
               const GraspLiftConfig& config, const MotionConfig& motion);

}  // namespace gusset
