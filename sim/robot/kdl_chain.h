#pragma once

#include <Eigen/Geometry>
#include <kdl/chain.hpp>

#include "sim/robot/arm_model.h"

namespace gusset {

/// The arm from base link to tool as a KDL chain, for its solvers. Links beside the chain (fingers)
/// count as part of the link they hang on, in their pose at joint zero.
KDL::Chain MakeKdlChain(const ArmModel& arm);

KDL::Frame ToKdl(const Eigen::Isometry3d& X);

}  // namespace gusset
