#pragma once

#include <functional>
#include <numbers>
#include <vector>

#include "sim/robot/arm_environment.h"
#include "sim/robot/arm_model.h"

namespace gusset {

inline constexpr double kDegree = std::numbers::pi / 180;

/// The default iiwa without its visuals, loaded once.
inline const ArmModel& Iiwa() {
  static const ArmModel arm =
      ArmModel::Load({}, std::filesystem::path(GUSSET_SOURCE_DIR) / "assets", false);
  return arm;
}

/// Air, in which tests put forces, blocks and records.
class FakeEnvironment : public ArmEnvironment {
 public:
  double step_s() const override { return 0.001; }
  void Step(const std::vector<Eigen::Isometry3d>& X_WL, double finger_opening_m,
            bool at_rest) override {
    ++steps;
    rest_steps += at_rest ? 1 : 0;
    opening_m = finger_opening_m;
    X_WT = X_WL[*Iiwa().robot().FindLink("tool")];
  }
  Eigen::Vector3d ForceOnTool() const override {
    return force ? force(X_WT) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }
  double PadForce() const override { return pad_force ? pad_force(opening_m) : 0.0; }
  bool PadsBlocked() const override { return blocked && blocked(opening_m); }
  void BeginHold(double force_N) override { hold_N = force_N; }
  void EndHold() override { hold_N = 0; }

  int steps = 0, rest_steps = 0;
  double opening_m = 0.085;
  double hold_N = 0;
  Eigen::Isometry3d X_WT = Iiwa().ToolPose(Iiwa().waiting());
  std::function<Eigen::Vector3d(const Eigen::Isometry3d&)> force;
  std::function<double(double)> pad_force;
  std::function<bool(double)> blocked;
};

}  // namespace gusset
