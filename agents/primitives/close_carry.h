#pragma once

#include <optional>

#include "agents/primitives/grasp_lift.h"
#include "agents/primitives/mouth.h"
#include "agents/primitives/scratch_drag.h"
#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_close and mu_carry, the pair of s3. Section [primitives.close_carry]. Heights are those of
/// the fingertips; all tuned.
struct CloseCarryConfig {
  double lips_apart_m = 0.03;   ///< Lips farther apart than this are brought together first:
  double lip_behind_m = 0.024;  ///< the drawn one, grasped so far behind where its labels are, so
                                ///< that the fingers miss the cube before it, is pressed onto the
                                ///< other where the bag is then grasped.
  double lip_release_m = 0;     ///< > 0: it is let go of so high over it instead, and looked at.
                                ///< Canvas springs back then, limp cloth does not.
  int lip_drops = 2;            ///< So often at most.
  double rim_inset_m = 0;       ///< The bag is grasped no deeper than so far behind the near lip,
                                ///< which is seen by its labels, 7 mm behind the edge ...
  double rim_aside_m = 0.03;    ///< ... and no farther aside from its middle.
  double opening_m = 0.085;     ///< Wide: both layers are to be gathered.
  double height_m = 0;          ///< Above the table, where the fingers close; a flat bag is 3 mm.
  double contact_force_N = 10;  ///< Felt earlier (on the cube, say): close there.
  int retries = 3;              ///< Where the pads meet on nothing, so often again, ...
  double retry_step_m = 0.015;  ///< ... each time so much nearer to the cube, until beside it.
  double lift_speed_m_s = 0.12;
  double upright_m = 0.10;  ///< Straight up to here, then also towards the table's middle ...
  double column_m = 0.08;   ///< ... to within so far of it, where the arm reaches high.
  double lift_height_m = 0.30;
  double tilt_deg = -29;     ///< There; < 0: the wrist leans away from the base.
  double weigh_after_s = 1;  ///< In the waiting pose it has stopped swinging so much later.
  double filled_N = 0.7;     ///< What weighs less then has lost the cube: Bag 1's 52 g and half of
                             ///< the cube's 40. Each bag's file has its own.
  double behind_m = 0.05;  ///< It is laid down again, from so far on the cube's side of the table's
                           ///< middle to the other.

  template <class V>
  void Fields(V& v) {
    v("lips_apart_m", lips_apart_m, Range{0, 1});
    v("lip_behind_m", lip_behind_m, Range{-0.05, 0.05});
    v("lip_release_m", lip_release_m, Range{0, 0.1});
    v("lip_drops", lip_drops, Range{1, 10});
    v("rim_inset_m", rim_inset_m, Range{0, 1});
    v("rim_aside_m", rim_aside_m, Range{0, 1});
    v("opening_m", opening_m, Range{0.01, 0.085});
    v("height_m", height_m, Range{0, 0.1});
    v("contact_force_N", contact_force_N, Range{0.5, 40});
    v("retries", retries, Range{0, 10});
    v("retry_step_m", retry_step_m, Range{0, 0.1});
    v("lift_speed_m_s", lift_speed_m_s, Range{0.01, 1});
    v("upright_m", upright_m, Range{0.02, 0.2});
    v("column_m", column_m, Range{0, 0.2});
    v("lift_height_m", lift_height_m, Range{0.1, 0.36});
    v("tilt_deg", tilt_deg, Range{-40, 40});
    v("weigh_after_s", weigh_after_s, Range{0, 10});
    v("filled_N", filled_N, Range{0, 100});
    v("behind_m", behind_m, Range{0, 0.2});
  }
};

/// Whether the mouth's lips are apart and its drawn lip is one to be dropped, not pressed.
bool LipFalls(const std::optional<Mouth>& mouth, const CloseCarryConfig& config);

/// Carries the drawn lip over the cube and lets it fall onto the near one, where a bag grasped at
/// p_W would be grasped, and rises. The other parameters are those of CloseCarry.
void DropLip(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
             const Mouth& mouth, const Eigen::Vector3d& cube_W, const CloseCarryConfig& config,
             const ScratchDragConfig& drag, const GraspLiftConfig& lift,
             const MotionConfig& motion);

/// Draws the mouth's lips together over what lies in it (unless the drawn one is to fall: DropLip
/// comes before this), closes the gripper on both at p_W, or
/// beside it at the rim, lifts the bag and carries it to the waiting pose. There it is weighed: one
/// too light to have the cube in it is laid down on the table again and let go. What is out of
/// reach is grasped nearer to cube_W, as is a bag that the fingers miss.
/// @param closing_W horizontal direction along which the fingers close where the tool is not
/// tilted.
/// @param mouth none if it is not seen: then nothing is drawn, and the grasp is at p_W.
/// @param cube_W where the cube is, or the bag if it hides the cube: a bag is laid down away from
/// it.
/// @param drag how a lip is drawn. @param lift how a bag is laid down, and how far the arm reaches.
void CloseCarry(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
                const std::optional<Mouth>& mouth, const Eigen::Vector3d& cube_W,
                const CloseCarryConfig& config, const ScratchDragConfig& drag,
                const GraspLiftConfig& lift, const MotionConfig& motion);

}  // namespace gusset
