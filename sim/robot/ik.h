#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <optional>

#include "sim/robot/arm_model.h"

namespace gusset {

/// Inverse kinematics of the arm, within its joint limits less the config's margin. A redundant
/// arm's spare freedom is drawn towards the config's posture, so that equal poses get (nearly)
/// equal joints whatever came before. Deterministic. Holds scratch space: one per thread. `arm`
/// must outlive it.
class IkSolver {
 public:
  explicit IkSolver(const ArmModel& arm);
  ~IkSolver();

  /// Joints that put the tool at X_WT (within 1e-6 m and rad): of the solutions found from `near`,
  /// the posture and the gate, the one soonest reached from `near` and closest to the posture.
  /// Where all fail, up to `restarts` random seeds (KDL's Levenberg-Marquardt solver), then KDL's
  /// Newton-Raphson solver with joint limits. ~0.5 ms; some 10 ms where there is no solution.
  std::optional<JointVector> Solve(const Eigen::Isometry3d& X_WT, const JointVector& near,
                                   int restarts = 20);

  /// As Solve, but only the solution continuous with `seed`, which must be near: some damped Newton
  /// steps, ~10 us. What lines are followed with. Limits are not looked at.
  std::optional<JointVector> Track(const Eigen::Isometry3d& X_WT, const JointVector& seed) const;

 private:
  struct Impl;
  std::optional<JointVector> FromSeed(const Eigen::Isometry3d& X_WT, const JointVector& seed);
  std::optional<JointVector> Settle(const Eigen::Isometry3d& X_WT, JointVector q) const;
  const ArmModel& arm_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gusset
