#pragma once

#include <Eigen/Core>
#include <memory>

#include "sim/robot/arm_model.h"

namespace gusset {

/// Joint torques of the arm by KDL's recursive Newton-Euler solver. Holds scratch space: one per
/// thread. `arm` must outlive it.
class ArmDynamics {
 public:
  explicit ArmDynamics(const ArmModel& arm);
  ~ArmDynamics();

  /// Torques (N m) that the motors give in state (q, qd, qdd) under gravity, the gripper's weight
  /// included, while force_W (N) acts on the tool's origin.
  JointVector Torques(const JointVector& q, const JointVector& qd, const JointVector& qdd,
                      const Eigen::Vector3d& force_W);
  /// The force at the tool's origin that explains best, in the sense of least squares, how the
  /// motors' torques differ from those of the free arm in the same state. Zero where the arm's
  /// configuration lets no force be told from the torques.
  /// @param excess_Nm  measured torques less Torques(q, qd, qdd, 0).
  Eigen::Vector3d ForceFromTorques(const JointVector& q, const JointVector& excess_Nm) const;

 private:
  struct Impl;
  const ArmModel& arm_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gusset
