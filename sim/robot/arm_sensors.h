#pragma once

#include <cstdint>

#include "base/random.h"
#include "sim/robot/arm_dynamics.h"
#include "sim/robot/trajectory.h"

namespace gusset {

/// The joint torque sensors and what the arm's controller concludes from them. `arm` must outlive
/// it.
class ArmSensors {
 public:
  ArmSensors(const ArmModel& arm, std::uint64_t seed);

  /// Readings from here on depend on the seed and on what is asked, not on what was asked before.
  void Seed(std::uint64_t seed) { rng_ = Rng(seed); }
  /// What the torque sensors show (N m, Gaussian noise) while force_W acts on the tool.
  JointVector Torques(const JointState& state, const Eigen::Vector3d& force_W);
  /// One noisy estimate of the force on the tool (N, world frame), unbiased: the torques above
  /// less those that the arm's and the gripper's own weight and motion explain.
  Eigen::Vector3d Force(const JointState& state, const Eigen::Vector3d& force_W);
  /// Mean of `readings` such estimates.
  Eigen::Vector3d MeanForce(const JointState& state, const Eigen::Vector3d& force_W, int readings);
  /// True torques (N m), without the sensors' noise.
  JointVector TrueTorques(const JointState& state, const Eigen::Vector3d& force_W);

 private:
  JointVector Noise();
  const ArmModel& arm_;
  ArmDynamics dynamics_;
  Rng rng_;
};

}  // namespace gusset
