#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include "agents/agent.h"
#include "base/random.h"

namespace gusset {

/// The policy's action.
inline int GreedyAction(const Agent& agent, int state, int n_actions) {
  Rng rng(0);
  return agent.Act(state, {}, n_actions, Mode::kGreedy, rng).action;
}

/// The identity task: in state s action s earns 1, any other 0, and the episode is over.
/// @returns every action taken.
inline std::vector<int> PlayIdentity(Agent& agent, int states, int steps, std::uint64_t seed,
                                     int first_step = 0) {
  std::vector<int> taken;
  for (int i = first_step; i < first_step + steps; ++i) {
    Rng rng(DeriveSeed(seed, "agent", static_cast<std::uint64_t>(i)));
    const int s = i % states;
    const int action = agent.Act(s, {}, states, Mode::kExplore, rng).action;
    taken.push_back(action);
    agent.Learn({.state = s,
                 .action = action,
                 .n_actions = states,
                 .reward = action == s ? 1.0 : 0.0,
                 .next_state = s,
                 .done = true});
  }
  return taken;
}

/// Stopped after `steps`, written as text, read into a new agent and continued for as long again:
/// the same actions and the same bits as without the stop.
inline void ExpectContinuedEqualsUninterrupted(const std::function<std::unique_ptr<Agent>()>& make,
                                               int steps) {
  const std::unique_ptr<Agent> whole = make();
  PlayIdentity(*whole, 4, steps, 1);
  const std::unique_ptr<Agent> continued = make();
  PlayIdentity(*continued, 4, 7, 2);  // so that Load has something to replace
  continued->Load(nlohmann::json::parse(whole->Save().dump()));
  EXPECT_EQ(continued->Save().dump(), whole->Save().dump());
  EXPECT_EQ(PlayIdentity(*continued, 4, steps, 1, steps), PlayIdentity(*whole, 4, steps, 1, steps));
  EXPECT_EQ(continued->Save().dump(), whole->Save().dump());
}

/// A chain s0 - s1 - s2 - end: action 1 goes on, action 0 stays. Only the end pays, 1; staying
/// costs 0.1. So Q*(s, 1) = gamma^(2 - s), Q*(s, 0) = -0.1 + gamma Q*(s, 1).
struct Chain {
  static constexpr int kStates = 3;
  static constexpr double kGamma = 0.9;
  static std::vector<int> ActionCounts() { return {2, 2, 2}; }
  static double BestValue(int state, int action) {
    const double onward = std::pow(kGamma, kStates - 1 - state);
    return action == 1 ? onward : -0.1 + kGamma * onward;
  }
  /// Lets the agent act and learn for so many steps.
  static void Play(Agent& agent, int steps, std::uint64_t seed = 4) {
    int state = 0;
    bool follows = false;
    for (int i = 0; i < steps; ++i) {
      Rng rng(DeriveSeed(seed, "chain", static_cast<std::uint64_t>(i)));
      const int action = agent.Act(state, {}, 2, Mode::kExplore, rng).action;
      const int next = state + action;
      const bool done = next == kStates;
      agent.Learn({.state = state,
                   .action = action,
                   .n_actions = 2,
                   .reward = done          ? 1.0
                             : action == 1 ? 0.0
                                           : -0.1,
                   .next_state = next,
                   .done = done,
                   .follows = follows});
      state = done ? 0 : next;
      follows = !done;
    }
  }
};

}  // namespace gusset
