#include "sim/robot/arm_sensors.h"

namespace gusset {

ArmSensors::ArmSensors(const ArmModel& arm, std::uint64_t seed)
    : arm_(arm), dynamics_(arm), rng_(seed) {}

JointVector ArmSensors::Noise() {
  JointVector noise(arm_.num_joints());
  for (double& value : noise) value = arm_.config().torque_noise_Nm * rng_.Normal();
  return noise;
}

JointVector ArmSensors::TrueTorques(const JointState& state, const Eigen::Vector3d& force_W) {
  return dynamics_.Torques(state.q, state.qd, state.qdd, force_W);
}

JointVector ArmSensors::Torques(const JointState& state, const Eigen::Vector3d& force_W) {
  return TrueTorques(state, force_W) + Noise();
}

// The controller's model of the arm is the arm itself, so what its model leaves unexplained is
// -J^T F and the noise; solving for F gives back F and the noise's share.
Eigen::Vector3d ArmSensors::Force(const JointState& state, const Eigen::Vector3d& force_W) {
  return force_W + dynamics_.ForceFromTorques(state.q, Noise());
}

Eigen::Vector3d ArmSensors::MeanForce(const JointState& state, const Eigen::Vector3d& force_W,
                                      int readings) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < readings; ++i) sum += Force(state, force_W);
  return sum / readings;
}

}  // namespace gusset
