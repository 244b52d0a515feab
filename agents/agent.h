#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "base/random.h"

namespace gusset {

/// How an agent chooses.
enum class Mode {
  kExplore,  ///< While training: may explore, breaks ties at random.
  kGreedy,   ///< The policy: the best action known, the lowest index among equals.
};

/// What an agent chose.
struct Decision {
  int action = 0;         ///< In [0, n_actions).
  bool explored = false;  ///< Drawn at random rather than for its value.
  double epsilon = 0;     ///< Probability with which this choice was random.
};

/// What followed from an action.
struct Transition {
  int state = 0;
  std::vector<double> features = {};  ///< The state's continuous part, for agents that want more.
  int action = 0;
  int n_actions = 0;
  double reward = 0;
  int next_state = 0;
  std::vector<double> next_features = {};
  bool done = false;     ///< The episode ended here.
  bool follows = false;  ///< The world is the one that the transition learnt before this one left.
};

/// A learner of discrete actions. It knows neither robot nor bag: states and actions are indices,
/// rewards numbers. One learner, one file.
class Agent {
 public:
  virtual ~Agent() = default;
  /// Chooses among the n_actions that the state affords. All randomness comes from `rng`; safe to
  /// call from several threads between two calls of Learn.
  virtual Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
                       Rng& rng) const = 0;
  /// Called by one thread at a time, not always the same.
  virtual void Learn(const Transition& transition) = 0;
  /// Everything learnt, for a person to read and for Load. Load(Save()) changes nothing.
  virtual nlohmann::json Save() const = 0;
  /// @throws InputError naming what is missing or out of bounds; the agent is then unchanged.
  virtual void Load(const nlohmann::json& saved) = 0;
  /// Name by which the command line knows it.
  virtual std::string name() const = 0;
};

}  // namespace gusset
