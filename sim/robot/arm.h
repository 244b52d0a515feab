#pragma once

#include <optional>

#include "sim/robot/arm_model.h"
#include "sim/robot/trajectory.h"

namespace gusset {

/// The arm in motion: follows one trajectory at a time, exactly, and can stop early on it. Keeps
/// the joints' speed and acceleration limits in both. `arm` must outlive it.
class Arm {
 public:
  /// At rest in the waiting configuration.
  explicit Arm(const ArmModel& arm);

  /// Puts the arm at rest at q, whatever it did.
  void Place(const JointVector& q);
  /// Begins a trajectory, which must start where the arm is. The arm must be at rest.
  void Start(const Trajectory& trajectory);
  /// Slows down along the trajectory as hard as the acceleration limits allow. No effect at rest.
  void Stop();
  /// Advances by step_s; at the trajectory's end or when stopped the arm is exactly at rest.
  void Step(double step_s);

  bool moving() const { return trajectory_.has_value(); }
  const JointState& state() const { return state_; }

 private:
  double Braking() const;
  const ArmModel& arm_;
  JointState state_;
  std::optional<Trajectory> trajectory_;
  double time_s_ = 0;  // on the trajectory's own clock
  double rate_ = 1;    // of that clock; below 1 when stopping
  bool stopping_ = false;
};

}  // namespace gusset
