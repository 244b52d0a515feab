#pragma once

#include <string>
#include <vector>

#include "agents/action_table.h"
#include "agents/agent.h"
#include "base/config.h"

namespace gusset {

/// Settings of Pi-learning.
struct PiConfig {
  /// "mean": running mean of the rewards. "published": Eq. 5.9 to the letter. "last": the last
  /// reward, as the authors' code had it.
  std::string update = "mean";
  double epsilon_min = 0.05;  ///< Exploration left at the end (authors' code); 0: none.
  int steps_per_state = 100;  ///< N, over which epsilon falls; the trainer sets it.

  template <class V>
  void Fields(V& v) {
    v("update", update, std::vector<std::string>{"mean", "published", "last"});
    v("epsilon_min", epsilon_min, Range{0, 1});
  }
};

/// Pi-learning, Algorithm 8 of the thesis: a table of how good each action was in its state, blind
/// to the state that follows (Eq. 5.9); the policy is its argmax (Eq. 5.11).
class PiLearning final : public Agent {
 public:
  /// @param n_actions how many actions each state affords (Eq. 5.7).
  /// @throws InputError if `config` is out of bounds.
  PiLearning(const PiConfig& config, const std::vector<int>& n_actions);

  Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
               Rng& rng) const override;
  void Learn(const Transition& transition) override;
  nlohmann::json Save() const override;
  void Load(const nlohmann::json& saved) override;
  std::string name() const override { return "pi"; }

  /// min(1, epsilon_min + (1 - epsilon_min)(1 - n/N)), n = steps learnt in this state.
  double Epsilon(int state) const;
  double value(int state, int action) const { return table_.at(state, action).value; }
  int count(int state, int action) const { return table_.at(state, action).count; }
  int best(int state) const { return table_.best(state); }
  int steps(int state) const { return table_.steps(state); }

 private:
  PiConfig config_;
  ActionTable table_;  // Pi(s, a)
};

/// Pi-learning's exploration, which the other tabular learners share so that they can be compared.
/// @returns min(1, epsilon_min + (1 - epsilon_min)(1 - steps/N)).
double FallingEpsilon(double epsilon_min, int steps, int steps_per_state);

}  // namespace gusset
