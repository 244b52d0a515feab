#pragma once

#include <string>

#include "sim/robot/sim_robot.h"
#include "sim/world.h"

namespace gusset {

/// World and arm between two actions, as bytes: exact, for this machine's kind.
std::string PackSnapshot(const WorldState& world, const SimRobotState& robot);

/// @throws InputError if the bytes are not a snapshot, are cut short, have changed, or hold a
/// number that is not finite.
void UnpackSnapshot(const std::string& bytes, WorldState& world, SimRobotState& robot);

}  // namespace gusset
