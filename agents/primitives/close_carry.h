#pragma once

#include "agents/primitives/tool_motion.h"

namespace gusset {

/// tau_close and mu_carry, the pair of s3. Section [primitives.close_carry]. Heights are those of
/// the fingertips; all tuned.
struct CloseCarryConfig {
  double opening_m = 0.085;     ///< Wide: both layers are to be gathered.
  double height_m = 0;          ///< Above the table, where the fingers close; a flat bag is 3 mm.
  double contact_force_N = 10;  ///< Felt earlier (on the cube, say): close there.
  double lift_speed_m_s = 0.12;
  double upright_m = 0.10;  ///< Straight up to here, then also towards the table's middle ...
  double column_m = 0.08;   ///< ... to within so far of it, where the arm reaches high.
  double lift_height_m = 0.30;
  double tilt_deg = -29;  ///< There; < 0: the wrist leans away from the base.

  template <class V>
  void Fields(V& v) {
    v("opening_m", opening_m, Range{0.01, 0.085});
    v("height_m", height_m, Range{0, 0.1});
    v("contact_force_N", contact_force_N, Range{0.5, 40});
    v("lift_speed_m_s", lift_speed_m_s, Range{0.01, 1});
    v("upright_m", upright_m, Range{0.02, 0.2});
    v("column_m", column_m, Range{0, 0.2});
    v("lift_height_m", lift_height_m, Range{0.1, 0.36});
    v("tilt_deg", tilt_deg, Range{-40, 40});
  }
};

/// Closes the gripper on the bag at p_W and lifts it. The waiting pose, to which the arm then goes
/// with what it holds, is the rest of mu_carry.
/// @param closing_W horizontal direction along which the fingers close.
void CloseCarry(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& closing_W,
                const CloseCarryConfig& config, const MotionConfig& motion);

}  // namespace gusset
