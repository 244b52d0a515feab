#include "agents/primitives/scratch_drag.h"

#include <algorithm>

namespace gusset {

void ScratchDrag(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& target_W,
                 const Eigen::Vector3d& along_W, const ScratchDragConfig& config,
                 const MotionConfig& motion) {
  const Eigen::Vector3d drag = At(target_W - p_W, 0);
  const double length = std::clamp(drag.norm(), config.drag_least_m, config.drag_most_m);
  DrawLayer(tool, p_W, length * drag.normalized(), along_W, config, motion);
}

void DrawLayer(ToolMotion& tool, const Eigen::Vector3d& p_W, const Eigen::Vector3d& drag_W,
               const Eigen::Vector3d& along_W, const ScratchDragConfig& config,
               const MotionConfig& motion) {
  const Eigen::Vector3d drag = Within(config.drag_most_m, drag_W);
  Eigen::Vector3d grasp_W = p_W;
  const auto grasp = [&](double z) { return At(grasp_W, z); };
  const auto target = [&](double z) { return Eigen::Vector3d(grasp(z) + drag); };

  // tau_scratch: touch the cloth, close along the rim.
  tool.Fingers(config.opening_m);
  tool.Approach(grasp(motion.approach_m), AngleOf(along_W));
  tool.Go(grasp(p_W.z() + 0.02), motion.descend_speed_m_s);
  // Thick cloth between the pads is mostly both layers: let go of it and try beside it, where the
  // cloth is not rucked up yet.
  const Eigen::Vector3d aside = along_W.dot(drag) < 0 ? Eigen::Vector3d(-along_W) : along_W;
  double touched = 0;
  for (int moved = 0;; ++moved) {
    touched = tool.Seize(grasp(-0.005), config.opening_m,
                         {config.touch_force_N, config.retries, config.press_factor})
                  .z();
    if (tool.opening_m() <= config.stack_m || moved == config.asides) break;
    tool.Fingers(config.opening_m);
    tool.Go(grasp(touched + 0.02), motion.descend_speed_m_s);
    grasp_W += config.aside_m * aside;
    tool.Go(grasp(touched + 0.02), motion.descend_speed_m_s);
  }

  // mu_drag: raise the layer, carry it over the target, let go.
  tool.Go(grasp(touched + config.lift_m), config.drag_speed_m_s);
  tool.Go(target(touched + config.lift_m), config.drag_speed_m_s);
  tool.Go(target(config.release_height_m), config.drag_speed_m_s);
  tool.Fingers(config.release_opening_m);
  tool.Go(target(motion.approach_m), config.rise_speed_m_s);
}

void LayLipOver(ToolMotion& tool, const Mouth& mouth, double grasp_before_m, double over_m,
                const Eigen::Vector3d& along_W, const ScratchDragConfig& config,
                const MotionConfig& motion) {
  const Eigen::Vector3d outward = mouth.Outward_W();
  const Eigen::Vector3d grasp = mouth.drawn_W + grasp_before_m * outward;
  DrawLayer(tool, grasp, mouth.Apart_W() + over_m * outward, along_W, config, motion);
}

}  // namespace gusset
