#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "agents/agent.h"
#include "agents/environment.h"

namespace gusset {

/// How the steps of the task are tried one by one.
struct AttemptConfig {
  StartKind folded = StartKind::kFolded;      ///< What step 1 starts from.
  StartKind unfolded = StartKind::kUnfolded;  ///< What step 2 may start from.
  int attempts = 20;                          ///< At each step.
  std::uint64_t seed = 7;
};

/// How one step went.
struct StepAttempts {
  int attempts = 0;        ///< Fewer than asked for only if no bag could be brought that far.
  int true_successes = 0;  ///< A later state of the task followed; in step 4 the task was done.
  int seen_successes = 0;  ///< The same as the camera saw it.
  double reward = 0;       ///< Sum over the attempts.
  int own_bags = 0;        ///< Bags that this policy's step before left, of those tried.
};

struct AttemptResult {
  std::array<StepAttempts, 4> steps;
  int actions = 0;  ///< With those that brought bags into a state.
  double sim_s = 0;
};

/// Tries every step of the task `attempts` times: one greedy action on a bag that the camera sees
/// in the step's state. Step 1 starts from new folded bags. The others start from what the step
/// before left: its attempts first; then, while bags are missing, further greedy actions of that
/// step (two per attempt at most); then, for a policy that does not get there, bags laid out flat
/// (step 2) or left by random fitting actions (steps 3 and 4, four per attempt at most). If there
/// are fewer bags than attempts still, they are taken again, in turn, under new sensor noise.
///
/// Depends on (policy, config) only. @throws RunError if `stop` becomes true, Interrupted.
AttemptResult AttemptSteps(Environment& environment, const Agent& agent,
                           const AttemptConfig& config, const std::function<bool()>& stop);

}  // namespace gusset
