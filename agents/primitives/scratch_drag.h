#pragma once

#include "agents/primitives/mouth.h"
#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_scratch and mu_drag, the pair of s1. Section [primitives.scratch_drag]. Heights are those of
/// the fingertips. All tuned: whether one layer is caught, both or none is decided by the height at
/// which touch_force_N is felt, against the cloth's thickness.
struct ScratchDragConfig {
  double opening_m = 0.085;    ///< Between the fingers as they come down: wide, for a single layer.
  double touch_force_N = 0.5;  ///< Felt when the fingertips rest on the cloth.
  int retries = 3;             ///< If nothing is between the pads then, so often again,
  double press_factor = 1.2;   ///< pressing so many times as hard.
  double stack_m = 0.0105;     ///< More than this between the closed pads is taken for both layers.
  int asides = 2;              ///< Then, or still without any, the fingers try again so often ...
  double aside_m = 0.03;       ///< ... so far along the rim, the way that the drag goes, ...
  double firm_force_N = 6;     ///< ... pressing so hard the last time if none before it caught
                               ///< anything (and harder as retries go; the first is never firm).
  double lift_m = 0.10;        ///< The layer is raised so far, clear of the cube, ...
  double drag_m = 0.175;       ///< ... and dragged so far towards the target: a shorter flap of
                               ///< canvas springs back, and the further, the closer the lip draws
                               ///< the rim's corners together. Limp cloth stays anyway: Bag 2's
                               ///< file has less.
  double drag_speed_m_s = 0.15;
  double release_height_m = 0.02;
  double release_opening_m = 0.045;  ///< Half open: enough to let go of one layer.
  double rise_speed_m_s = 0.10;

  template <class V>
  void Fields(V& v) {
    v("opening_m", opening_m, Range{0.005, 0.085});
    v("touch_force_N", touch_force_N, Range{0.2, 20});
    v("retries", retries, Range{0, 10});
    v("press_factor", press_factor, Range{1, 3});
    v("stack_m", stack_m, Range{0, 0.085});
    v("asides", asides, Range{0, 10});
    v("aside_m", aside_m, Range{0, 0.1});
    v("firm_force_N", firm_force_N, Range{0.2, 20});
    v("lift_m", lift_m, Range{0.01, 0.25});
    v("drag_m", drag_m, Range{0.02, 0.5});
    v("drag_speed_m_s", drag_speed_m_s, Range{0.01, 1});
    v("release_height_m", release_height_m, Range{0.005, 0.3});
    v("release_opening_m", release_opening_m, Range{0.01, 0.085});
    v("rise_speed_m_s", rise_speed_m_s, Range{0.01, 1});
  }
};

/// Scratches up the cloth at p_W, the fingers closing along the rim, and drags it towards target_W.
/// @param along_W direction of the rim, horizontal.
void ScratchDrag(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& target_W,
                 const Eigen::Vector3d& along_W, const ScratchDragConfig& config,
                 const MotionConfig& motion);

/// tau_scratch alone: touches the cloth at p_W and closes along the rim (along_W), or across the
/// tilt where the tool is tilted (ToolMotion::ApproachLevel); beside p_W, on the side
/// that drag_W leads to, if none or both layers seem to be between the pads. @returns where the
/// fingers closed.
Eigen::Vector3d SeizeLayer(ToolMotion& tool, const Eigen::Vector3d& p_W,
                           const Eigen::Vector3d& drag_W, const Eigen::Vector3d& along_W,
                           const ScratchDragConfig& config, const MotionConfig& motion);

/// The first part of mu_drag: raises what is held at seized_W, carries it over target_W and lowers
/// it.
void BringLayer(ToolMotion& tool, const Eigen::Vector3d& seized_W, const Eigen::Vector3d& target_W,
                const ScratchDragConfig& config);

/// Scratches and drags by drag_W, however far that is.
void DrawLayer(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& drag_W,
               const Eigen::Vector3d& along_W, const ScratchDragConfig& config,
               const MotionConfig& motion);

}  // namespace gusset
