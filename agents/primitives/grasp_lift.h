#pragma once

#include <functional>

#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_grasp and mu_lift, the pair of s0. Section [primitives.grasp_lift]. Heights are those of the
/// fingertips above the table; lengths lie in the table's plane. All tuned, 2026-11, on folded
/// starts of Bag 1 (docs/primitives.md).
struct GraspLiftConfig {
  double opening_m = 0.025;       ///< Fingers go down so far apart: wider, they gather more plies.
  double touch_speed_m_s = 0.04;  ///< Down onto the cloth: folds give way further than one layer,
                                  ///< so not as slowly as MotionConfig::guarded_speed_m_s.
  double contact_force_N = 0.7;   ///< Felt on the way down: close there (with more, they gather the
                                  ///< plies of both halves of a folded bag) ...
  int retries = 3;                ///< ... and if nothing is between the pads then, so often again,
  double press_factor = 1.6;      ///< pressing so many times as hard.
  double lift_speed_m_s = 0.25;
  double lift_low_m = 0.30;    ///< Height for parameter 0 (0.36 is out of reach) ...
  double lift_step_m = 0.002;  ///< ... and from one parameter to the next.
  double tilt_deg = -29;       ///< Of the gripper above tilt_above_m (29 in the authors' code);
                               ///< < 0: the wrist leans away from the base.
  double tilt_above_m = 0.22;
  double trail_m = 0.15;  ///< It is lifted so far beyond the table's middle ...
  double lay_m = 0.17;    ///< ... and laid out to so far on this side of it.
  double lay_speed_m_s = 0.25;
  double probe_from_m = 0.22;   ///< Then its edge is felt for, from so far out ...
  double probe_step_m = 0.04;   ///< ... inwards in such steps, ...
  int probes = 6;               ///< ... so many times at most, ...
  double pull_m = 0.16;         ///< ... and pulled out so far, reach_m permitting, ...
  double pull_height_m = 0.06;  ///< ... over this height.
  bool looks = true;  ///< Between strokes, which end once it is unfolded: in s2 with a mouth that
                      ///< takes the cube, in s1 with ...
  double flat_share = 0.82;  ///< ... this much of the flat bag in sight. Tuned on Bag 1.
  double reach_m = 0.245;    ///< The fingertips stay this close to the table's middle.
  double release_height_m = 0.008;
  double release_opening_m = 0.045;  ///< Half open: wide open, they may stretch a fold they are in.
  double rise_m = 0.08;              ///< After a release, and before the next grasp.
  double rise_speed_m_s = 0.15;      ///< Away from the cloth, without pulling it along.

  double lift_height_m(int parameter) const { return lift_low_m + parameter * lift_step_m; }

  template <class V>
  void Fields(V& v) {
    v("opening_m", opening_m, Range{0.01, 0.085});
    v("touch_speed_m_s", touch_speed_m_s, Range{0.002, 0.25});
    v("contact_force_N", contact_force_N, Range{0.5, 10});
    v("retries", retries, Range{0, 10});
    v("press_factor", press_factor, Range{1, 3});
    v("lift_speed_m_s", lift_speed_m_s, Range{0.01, 1});
    v("lift_low_m", lift_low_m, Range{0.02, 0.36});
    v("lift_step_m", lift_step_m, Range{0, 0.04});
    v("tilt_deg", tilt_deg, Range{-40, 40});
    v("tilt_above_m", tilt_above_m, Range{0.05, 0.5});
    v("trail_m", trail_m, Range{0, 0.25});
    v("lay_m", lay_m, Range{0, 0.25});
    v("lay_speed_m_s", lay_speed_m_s, Range{0.01, 1});
    v("probe_from_m", probe_from_m, Range{0, 0.25});
    v("probe_step_m", probe_step_m, Range{0.005, 0.1});
    v("probes", probes, Range{1, 20});
    v("pull_m", pull_m, Range{0, 0.4});
    v("pull_height_m", pull_height_m, Range{0.02, 0.3});
    v("looks", looks);
    v("flat_share", flat_share, Range{0, 1});
    v("reach_m", reach_m, Range{0.05, 0.25});
    v("release_height_m", release_height_m, Range{0.005, 0.3});
    v("release_opening_m", release_opening_m, Range{0.01, 0.085});
    v("rise_m", rise_m, Range{0.02, 0.3});
    v("rise_speed_m_s", rise_speed_m_s, Range{0.01, 1});
  }
};

/// Lays what is held down along the way from high_W to to_W, its far end first, and lets go.
/// @param high_W over the table; there the tool is tilted, as tilt_deg has it, if that is high.
/// @param closing_rad the fingers' direction, as for DownwardTool.
/// @param opening_m so far they open.
void LayDown(ToolMotion& tool, const Eigen::Vector3d& high_W, const Eigen::Vector3d& to_W,
             double closing_rad, double opening_m, const GraspLiftConfig& config);

/// Unfolds in one to nine strokes. The first grasps the bag at p_W, or as near it as the arm
/// reaches, lifts it to lift_height_m(parameter), parameter 0 to 8, over the table's middle and
/// beyond, so that it hangs and unfolds under its weight, and lays it across the middle: its far
/// end comes down first and table friction holds it. The others pull it flat by its edges, which
/// they find by feel: on either side of that line (first on the left for odd parameters, on the
/// right for even ones), at its far end and at its near one. Where the bag can be looked at in
/// between, they end as soon as it is unfolded, and go on along the diagonals while it is not: a
/// pull unfolds one bag and folds the next one anew.
/// @param p_W a point at the bag's edge: held there it unfolds, held in the middle it does not.
/// @param centre_W the bag's centre as seen: the first stroke goes from it to p_W, but through the
///   table's middle, so that the bag does not wander out of sight.
/// @param is_unfolded leaves the camera's view and looks. Empty: there is no looking.
void GraspLift(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& centre_W,
               int parameter, const GraspLiftConfig& config, const MotionConfig& motion,
               const std::function<bool()>& is_unfolded = {});

/// GraspLift with its tool, settings and looks: what unfolds a bag for another pair.
using Unfold =
    std::function<void(const Eigen::Vector3d& p_W, const Eigen::Vector3d& centre_W, int parameter)>;

}  // namespace gusset
