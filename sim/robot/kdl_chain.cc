#include "sim/robot/kdl_chain.h"

#include <algorithm>
#include <string>

namespace gusset {
namespace {

KDL::Vector ToKdl(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

KDL::RigidBodyInertia Inertia(const RobotLink& link) {
  const Eigen::Matrix3d& I = link.inertia_L;
  const KDL::RotationalInertia about_com(I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2));
  return KDL::RigidBodyInertia(link.mass_kg, ToKdl(link.com_L), about_com);
}

}  // namespace

KDL::Frame ToKdl(const Eigen::Isometry3d& X) {
  const auto R = X.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1),
                        R(2, 2)),
          ToKdl(Eigen::Vector3d(X.translation()))};
}

KDL::Chain MakeKdlChain(const ArmModel& arm) {
  const std::vector<RobotLink>& links = arm.robot().links();
  const std::vector<RobotJoint>& joints = arm.robot().joints();
  std::vector<KDL::RigidBodyInertia> inertias;
  for (const RobotLink& link : links) inertias.push_back(Inertia(link));
  // Children come after their parents, so going backwards collects whole branches.
  for (int j = static_cast<int>(joints.size()) - 1; j >= 0; --j) {
    if (std::ranges::find(arm.chain_joints(), j) != arm.chain_joints().end()) continue;
    const RobotJoint& joint = joints[j];
    inertias[joint.parent] =
        inertias[joint.parent] + ToKdl(joint.Transform(0)) * inertias[joint.child];
  }
  KDL::Chain chain;
  for (const int j : arm.chain_joints()) {
    const RobotJoint& joint = joints[j];
    const KDL::Frame X_PJ = ToKdl(joint.X_PJ);
    KDL::Joint moves(joint.name, KDL::Joint::Fixed);
    if (joint.kind != RobotJoint::Kind::kFixed) {
      moves = KDL::Joint(
          joint.name, X_PJ.p, X_PJ.M * ToKdl(joint.axis_J),
          joint.kind == RobotJoint::Kind::kRevolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis);
    }
    chain.addSegment(KDL::Segment(links[joint.child].name, moves, X_PJ, inertias[joint.child]));
  }
  return chain;
}

}  // namespace gusset
