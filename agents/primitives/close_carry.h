#pragma once

#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_close and mu_carry, the pair of s3. Section [primitives.close_carry]. Heights are those of
/// the fingertips; all tuned.
struct CloseCarryConfig {
  double opening_m = 0.085;     ///< Wide: both layers are to be gathered.
  double height_m = 0.006;      ///< Above the table, where the fingers close.
  double contact_force_N = 10;  ///< Felt earlier (on the cube, say): close there.
  double lift_speed_m_s = 0.12;
  double lift_height_m = 0.30;

  template <class V>
  void Fields(V& v) {
    v("opening_m", opening_m, Range{0.01, 0.085});
    v("height_m", height_m, Range{0, 0.1});
    v("contact_force_N", contact_force_N, Range{0.5, 40});
    v("lift_speed_m_s", lift_speed_m_s, Range{0.01, 1});
    v("lift_height_m", lift_height_m, Range{0.1, 0.36});
  }
};

/// Closes the gripper on the bag at p_W and lifts it. The waiting pose, to which the arm then goes
/// with what it holds, is the rest of mu_carry.
/// @param closing_W horizontal direction along which the fingers close.
void CloseCarry(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
                const CloseCarryConfig& config, const MotionConfig& motion);

}  // namespace gusset
