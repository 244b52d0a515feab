#pragma once

#include <memory>
#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/deep/config.h"

namespace gusset {

/// Makes a network agent (docs/agents.md). Their library, and libtorch with it, is loaded when the
/// first one is asked for: it takes 0.3 s and 160 MB that the tabular learners have no use for.
/// @throws InputError if this build has none or the library cannot be loaded.
std::unique_ptr<Agent> LoadDeepAgent(const std::string& name, const DeepConfig& config,
                                     const std::vector<int>& n_actions);

/// Versions of what the networks are built on; empty unless one has been made.
nlohmann::ordered_json LoadedDeepVersions();

}  // namespace gusset
