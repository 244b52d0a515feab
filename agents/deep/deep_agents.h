#pragma once

#include <memory>
#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/deep/config.h"

namespace gusset {

/// The library's one entry, with a C name for dlsym: makes the network agent called `name` (dqn,
/// plain_dqn, double_dqn, dueling_dqn, a2c, ppo), which the caller owns.
/// @param n_actions how many actions each state offers.
/// @throws InputError if the config is out of bounds or no network has that name.
extern "C" Agent* GussetMakeDeepAgent(const std::string& name, const DeepConfig& config,
                                      const std::vector<int>& n_actions);
inline constexpr const char* kMakeDeepAgentSymbol = "GussetMakeDeepAgent";

/// What the networks' bits depend on besides this program: {"libtorch", "blas"} as JSON text, the
/// BLAS with the kernel that it has chosen for this processor.
extern "C" const char* GussetDeepVersions();
inline constexpr const char* kDeepVersionsSymbol = "GussetDeepVersions";

std::unique_ptr<Agent> MakeDqn(const std::string& name, const DeepConfig& config,
                               const std::vector<int>& n_actions);
std::unique_ptr<Agent> MakeA2c(const DeepConfig& config, const std::vector<int>& n_actions);
std::unique_ptr<Agent> MakePpo(const DeepConfig& config, const std::vector<int>& n_actions);

}  // namespace gusset
