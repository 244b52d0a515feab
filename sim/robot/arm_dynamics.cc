#include "sim/robot/arm_dynamics.h"

#include <cassert>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>

#include "base/gravity.h"
#include "sim/robot/kdl_chain.h"

namespace gusset {
namespace {

KDL::Vector GravityInBase(const ArmModel& arm) {
  const Eigen::Vector3d g = arm.X_WB().linear().transpose() * Eigen::Vector3d(0, 0, -kGravity_m_s2);
  return {g.x(), g.y(), g.z()};
}

}  // namespace

struct ArmDynamics::Impl {
  explicit Impl(const ArmModel& arm)
      : chain(MakeKdlChain(arm)),
        solver(chain, GravityInBase(arm)),
        q(arm.num_joints()),
        qd(arm.num_joints()),
        qdd(arm.num_joints()),
        torques(arm.num_joints()),
        wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()) {}
  KDL::Chain chain;
  KDL::ChainIdSolver_RNE solver;
  KDL::JntArray q, qd, qdd, torques;
  KDL::Wrenches wrenches;
};

ArmDynamics::ArmDynamics(const ArmModel& arm) : arm_(arm), impl_(std::make_unique<Impl>(arm)) {}
ArmDynamics::~ArmDynamics() = default;

JointVector ArmDynamics::Torques(const JointVector& q, const JointVector& qd,
                                 const JointVector& qdd, const Eigen::Vector3d& force_W) {
  const Eigen::Vector3d f = arm_.ToolPose(q).linear().transpose() * force_W;
  impl_->wrenches.back() = KDL::Wrench(KDL::Vector(f.x(), f.y(), f.z()), KDL::Vector::Zero());
  impl_->q.data = q;
  impl_->qd.data = qd;
  impl_->qdd.data = qdd;
  [[maybe_unused]] const int error =
      impl_->solver.CartToJnt(impl_->q, impl_->qd, impl_->qdd, impl_->wrenches, impl_->torques);
  assert(error == KDL::SolverI::E_NOERROR);
  return impl_->torques.data;
}

Eigen::Vector3d ArmDynamics::ForceFromTorques(const JointVector& q,
                                              const JointVector& excess_Nm) const {
  // A force F on the tool needs -J^T F more torque from the motors to hold still against it.
  Eigen::Isometry3d X_WT;
  ToolJacobian J;
  arm_.ToolJacobianAt(q, X_WT, J);
  const auto Jv = J.topRows<3>();
  const Eigen::Matrix3d A = Jv * Jv.transpose();
  if (A.determinant() < 1e-9) return Eigen::Vector3d::Zero();
  return -A.inverse() * (Jv * excess_Nm);
}

}  // namespace gusset
