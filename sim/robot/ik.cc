#include "sim/robot/ik.h"

#include <algorithm>
#include <cmath>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>
#include <numbers>

#include "base/random.h"
#include "sim/robot/kdl_chain.h"

namespace gusset {
namespace {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kPositionTolerance_m = 1e-6;
constexpr double kRotationTolerance_rad = 1e-6;
constexpr int kTrackSteps = 12;            // Newton converges in 3 or 4; tuned
constexpr double kTrackDamping = 1e-4;     // of singular values; keeps steps finite; tuned
constexpr double kPostureGain = 0.3;       // share of the way to the posture per Track; tuned
constexpr double kPostureStep_rad = 0.03;  // at most per joint and Track: lines stay smooth; tuned
constexpr double kAvoidStep_rad = 0.06;    // the same, away from the camera; tuned
constexpr double kComfortableClearance = 1.5;  // times the clearance asked for; tuned
constexpr double kLeastSpare = 1e-3;           // below: no spare freedom
constexpr int kSettleSteps = 40;               // Tracks that draw a solution to the posture; tuned
constexpr double kEpsLma = 1e-7;               // weighted pose error; rotation counts 0.01 per rad
constexpr int kLmaIterations = 60;

Vector6d PoseError(const Eigen::Isometry3d& X_WT, const Eigen::Isometry3d& X_WTarget) {
  Vector6d error;
  error.head<3>() = X_WTarget.translation() - X_WT.translation();
  const Eigen::AngleAxisd turn(X_WTarget.linear() * X_WT.linear().transpose());
  error.tail<3>() = turn.angle() * turn.axis();
  return error;
}

// Unit vector of the null space of J, its largest entry positive; zero if there is none. The
// projection 1 - J^+ J has squared column norms equal to its diagonal.
JointVector SpareDirection(const ToolJacobian& J, const Eigen::LDLT<Matrix6d>& JJt) {
  int joint = 0;
  double largest = 0;
  for (int i = 0; i < J.cols(); ++i) {
    const double spare = 1 - J.col(i).dot(JJt.solve(J.col(i)));
    if (spare > largest) {
      joint = i;
      largest = spare;
    }
  }
  if (largest < kLeastSpare) return JointVector::Zero(J.cols());
  const Vector6d column = J.col(joint);
  JointVector direction = -J.transpose() * JJt.solve(column);
  direction[joint] += 1;
  return direction / direction.norm();
}

// Step of the joints towards what is wanted besides the tool's pose: the posture, and more room
// before the camera where that is scarce.
JointVector Lean(const ArmModel& arm, const JointVector& q, const ToolJacobian& J,
                 const Eigen::LDLT<Matrix6d>& JJt) {
  JointVector lean = (kPostureGain * arm.posture_weight().cwiseProduct(arm.posture() - q))
                         .cwiseMax(-kPostureStep_rad)
                         .cwiseMin(kPostureStep_rad);
  const double wanted_m = kComfortableClearance * arm.config().camera_clearance_m;
  const double clearance_m = arm.CameraClearance(q);
  if (clearance_m >= wanted_m) return lean;
  const JointVector spare = SpareDirection(J, JJt);
  constexpr double kProbe_rad = 1e-3;
  const double slope_m = (arm.CameraClearance(q + kProbe_rad * spare) - clearance_m) / kProbe_rad;
  if (slope_m == 0) return lean;
  const double step_rad = kPostureGain * (wanted_m - clearance_m) / slope_m;
  return lean + std::clamp(step_rad, -kAvoidStep_rad, kAvoidStep_rad) * spare;
}

}  // namespace

struct IkSolver::Impl {
  explicit Impl(const ArmModel& arm)
      : chain(MakeKdlChain(arm)),
        lower(arm.num_joints()),
        upper(arm.num_joints()),
        lma(chain, kEpsLma, kLmaIterations),
        fk(chain),
        velocity(chain),
        nr(chain, lower, upper, fk, velocity, 100, kPositionTolerance_m) {
    lower.data = arm.limits().lower;
    upper.data = arm.limits().upper;
    nr.setJointLimits(lower, upper);
  }
  KDL::Chain chain;
  KDL::JntArray lower, upper;
  KDL::ChainIkSolverPos_LMA lma;
  KDL::ChainFkSolverPos_recursive fk;
  KDL::ChainIkSolverVel_pinv velocity;
  KDL::ChainIkSolverPos_NR_JL nr;
};

IkSolver::IkSolver(const ArmModel& arm) : arm_(arm), impl_(std::make_unique<Impl>(arm)) {}
IkSolver::~IkSolver() = default;

std::optional<JointVector> IkSolver::Track(const Eigen::Isometry3d& X_WTarget,
                                           const JointVector& seed) const {
  JointVector q = seed;
  Eigen::Isometry3d X_WT;
  ToolJacobian J;
  for (int step = 0; step < kTrackSteps; ++step) {
    arm_.ToolJacobianAt(q, X_WT, J);
    const Vector6d error = PoseError(X_WT, X_WTarget);
    // The first step always runs: it is the one that leans towards the posture.
    if (step > 0 && error.head<3>().norm() < kPositionTolerance_m &&
        error.tail<3>().norm() < kRotationTolerance_rad) {
      return q;
    }
    // dq = J^+ e + (1 - J^+ J) z with the damped pseudoinverse J^+ = J^T (J J^T + d^2)^-1.
    Matrix6d A = J * J.transpose();
    A.diagonal().array() += kTrackDamping * kTrackDamping;
    const Eigen::LDLT<Matrix6d> ldlt(A);
    const JointVector lean =
        step == 0 ? Lean(arm_, q, J, ldlt) : JointVector(JointVector::Zero(q.size()));
    const Vector6d drive = error - J * lean;
    JointVector dq = lean + J.transpose() * ldlt.solve(drive);
    const double largest = dq.cwiseAbs().maxCoeff();
    if (!std::isfinite(largest)) return std::nullopt;
    constexpr double kLargestStep_rad = 0.5;
    if (largest > kLargestStep_rad) dq *= kLargestStep_rad / largest;
    q += dq;
  }
  return std::nullopt;
}

std::optional<JointVector> IkSolver::Settle(const Eigen::Isometry3d& X_WT, JointVector q) const {
  for (int i = 0; i < q.size(); ++i) {
    if (arm_.robot().joints()[arm_.moving_joints()[i]].kind != RobotJoint::Kind::kRevolute)
      continue;
    q[i] = std::remainder(q[i], 2 * std::numbers::pi);
  }
  for (int i = 0; i < kSettleSteps; ++i) {
    const std::optional<JointVector> next = Track(X_WT, q);
    if (!next) return std::nullopt;
    const double moved = (*next - q).cwiseAbs().maxCoeff();
    q = *next;
    if (moved < 1e-3) break;
  }
  if (!arm_.WithinLimits(q)) return std::nullopt;
  return q;
}

std::optional<JointVector> IkSolver::FromSeed(const Eigen::Isometry3d& X_WT,
                                              const JointVector& seed) {
  KDL::JntArray from(arm_.num_joints()), to(arm_.num_joints());
  from.data = seed;
  const int result = impl_->lma.CartToJnt(from, ToKdl(arm_.X_WB().inverse() * X_WT), to);
  if (result != KDL::SolverI::E_NOERROR || !to.data.allFinite()) return std::nullopt;
  return Settle(X_WT, to.data);
}

std::optional<JointVector> IkSolver::Solve(const Eigen::Isometry3d& X_WT, const JointVector& near,
                                           int restarts) {
  if (!X_WT.matrix().allFinite()) return std::nullopt;
  const ArmLimits& limits = arm_.limits();
  const auto cost = [&](const JointVector& q) {
    const double time = (q - near).cwiseAbs().cwiseQuotient(limits.velocity).maxCoeff();
    return time + arm_.posture_weight().cwiseProduct(q - arm_.posture()).cwiseAbs().sum();
  };
  std::optional<JointVector> best;
  for (const JointVector& seed : {near, arm_.posture(), arm_.gate()}) {
    const std::optional<JointVector> found = FromSeed(X_WT, seed);
    if (found && (!best || cost(*found) < cost(*best))) best = found;
  }
  // The same seeds every time, so that equal questions get equal answers.
  Rng rng(DeriveSeed(0, "ik"));
  const JointVector lower = limits.lower.cwiseMax(-std::numbers::pi);
  const JointVector upper = limits.upper.cwiseMin(std::numbers::pi);
  for (int k = 0; k < restarts && !best; ++k) {
    JointVector seed(arm_.num_joints());
    for (int i = 0; i < seed.size(); ++i) seed[i] = rng.Uniform(lower[i], upper[i]);
    best = FromSeed(X_WT, seed);
  }
  if (!best && restarts > 0) {
    KDL::JntArray from(arm_.num_joints()), to(arm_.num_joints());
    from.data = arm_.posture();
    if (impl_->nr.CartToJnt(from, ToKdl(arm_.X_WB().inverse() * X_WT), to) >= 0) {
      best = Settle(X_WT, to.data);
    }
  }
  return best;
}

}  // namespace gusset
