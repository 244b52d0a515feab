#include "agents/primitives/scratch_drag.h"

namespace gusset {

void ScratchDrag(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& target_W,
                 const Eigen::Vector3d& along_W, const ScratchDragConfig& config,
                 const MotionConfig& motion) {
  const Eigen::Vector3d way = At(target_W - p_W, 0).normalized();
  DrawLayer(tool, p_W, config.drag_m * way, along_W, config, motion);
}

Eigen::Vector3d SeizeLayer(ToolMotion& tool, const Eigen::Vector3d& p_W,
                           const Eigen::Vector3d& drag_W, const Eigen::Vector3d& along_W,
                           const ScratchDragConfig& config, const MotionConfig& motion) {
  tool.Fingers(config.opening_m);
  tool.ApproachLevel(At(p_W, motion.approach_m), AngleOf(along_W));
  tool.Go(At(p_W, p_W.z() + 0.02), motion.descend_speed_m_s);
  // Thick cloth between the pads is mostly both layers: let go of it and try beside it, where the
  // cloth is not rucked up yet. Where they closed on nothing, cloth is too taut to be gathered so
  // lightly; the same grasp would fail again and again, so the last one is firm.
  const Eigen::Vector3d aside =
      (along_W.dot(drag_W) < 0 ? -config.aside_m : config.aside_m) * along_W;
  Eigen::Vector3d grasp_W = p_W;
  Press press{motion.guarded_speed_m_s, config.touch_force_N, config.retries, config.press_factor};
  bool caught = false;
  for (int moved = 0;; ++moved) {
    // A single try (PickPlace's widening) stays light.
    if (moved > 0 && moved == config.asides && !caught) press.force_N = config.firm_force_N;
    const double touched = tool.Seize(At(grasp_W, -0.005), config.opening_m, press).z();
    const bool one_layer = tool.Holds() && tool.opening_m() <= config.stack_m;
    if (one_layer || moved == config.asides) return At(grasp_W, touched);
    caught = caught || tool.Holds();
    tool.Fingers(config.opening_m);
    tool.Go(At(grasp_W, touched + 0.02), motion.descend_speed_m_s);
    grasp_W += aside;
    tool.Go(At(grasp_W, touched + 0.02), motion.descend_speed_m_s);
  }
}

void BringLayer(ToolMotion& tool, const Eigen::Vector3d& seized_W, const Eigen::Vector3d& target_W,
                const ScratchDragConfig& config) {
  const double raised = seized_W.z() + config.lift_m;
  tool.Go(At(seized_W, raised), config.drag_speed_m_s);
  tool.Go(At(target_W, raised), config.drag_speed_m_s);
  tool.Go(At(target_W, config.release_height_m), config.drag_speed_m_s);
}

void DrawLayer(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& drag_W,
               const Eigen::Vector3d& along_W, const ScratchDragConfig& config,
               const MotionConfig& motion) {
  // tau_scratch: touch the cloth, close along the rim.
  const Eigen::Vector3d seized_W = SeizeLayer(tool, p_W, drag_W, along_W, config, motion);

  // mu_drag: raise the layer, carry it over the target, let go.
  const Eigen::Vector3d target_W = seized_W + drag_W;
  BringLayer(tool, seized_W, target_W, config);
  tool.Fingers(config.release_opening_m);
  tool.Go(At(target_W, motion.approach_m), config.rise_speed_m_s);
}

}  // namespace gusset
