#include "sim/robot/arm.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace gusset {
namespace {

// Of the acceleration limits: what a stop uses at most, the trajectory's own bending included.
constexpr double kBrakingShare = 0.95;

}  // namespace

Arm::Arm(const ArmModel& arm) : arm_(arm) { Place(arm.waiting()); }

void Arm::Place(const JointVector& q) {
  assert(q.size() == arm_.num_joints());
  trajectory_.reset();
  state_.q = q;
  state_.qd = state_.qdd = JointVector::Zero(q.size());
}

void Arm::Start(const Trajectory& trajectory) {
  assert(!moving() && (trajectory.start() - state_.q).cwiseAbs().maxCoeff() < 1e-9);
  trajectory_ = trajectory;
  time_s_ = 0;
  rate_ = 1;
  stopping_ = false;
}

void Arm::Stop() { stopping_ = moving(); }

// With the trajectory's clock running at rate r, qd = r q' and qdd = r^2 q'' + dr/dt q'. The
// largest -dr/dt that keeps every |qdd| in its limit.
double Arm::Braking() const {
  JointState by_clock;
  trajectory_->Evaluate(time_s_, by_clock);
  double braking = std::numeric_limits<double>::infinity();
  for (int i = 0; i < by_clock.q.size(); ++i) {
    const double speed = std::abs(by_clock.qd[i]);
    if (speed < 1e-12) continue;
    const double left =
        kBrakingShare * arm_.limits().acceleration[i] - rate_ * rate_ * std::abs(by_clock.qdd[i]);
    braking = std::min(braking, left / speed);
  }
  return braking;
}

void Arm::Step(double step_s) {
  if (!moving()) return;
  double slowing = 0;
  if (stopping_) {
    slowing = std::min(Braking(), rate_ / step_s);
    time_s_ += (rate_ - 0.5 * slowing * step_s) * step_s;
    rate_ -= slowing * step_s;
  } else {
    time_s_ += step_s;
  }
  trajectory_->Evaluate(time_s_, state_);
  if (rate_ <= 0 || time_s_ >= trajectory_->duration_s()) {
    Place(JointVector(state_.q));
    return;
  }
  state_.qdd = rate_ * rate_ * state_.qdd - slowing * state_.qd;
  state_.qd *= rate_;
}

}  // namespace gusset
