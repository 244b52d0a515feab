#pragma once

#include <string>
#include <vector>

#include "agents/action_table.h"
#include "agents/agent.h"
#include "base/config.h"

namespace gusset {

/// Settings of Q-learning. Section [q_learning]. Conventional, not tuned.
struct QLearningConfig {
  double alpha = 0.1;         ///< Learning rate; 0: learns nothing, 1: the last target.
  double gamma = 0.99;        ///< Discount, as the network baselines have it; 0: blind to the next.
  double epsilon_min = 0.05;  ///< Exploration left at the end, as in Pi-learning; 0: none.
  int steps_per_state = 100;  ///< N, over which epsilon falls; the trainer sets it.

  template <class V>
  void Fields(V& v) {
    v("alpha", alpha, Range{0, 1});
    v("gamma", gamma, Range{0, 1});
    v("epsilon_min", epsilon_min, Range{0, 1});
  }
};

/// Tabular Q-learning (Watkins 1989; Watkins and Dayan 1992), the classical algorithm that the
/// thesis sets Pi-learning against (section 5.3.2). Explores as Pi-learning does.
class QLearning final : public Agent {
 public:
  /// @param n_actions how many actions each state affords.
  /// @throws InputError if `config` is out of bounds.
  QLearning(const QLearningConfig& config, const std::vector<int>& n_actions);

  Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
               Rng& rng) const override;
  void Learn(const Transition& transition) override;
  nlohmann::json Save() const override;
  void Load(const nlohmann::json& saved) override;
  std::string name() const override { return "q_learning"; }

  double value(int state, int action) const { return table_.at(state, action).value; }
  int best(int state) const { return table_.best(state); }

 private:
  QLearningConfig config_;
  ActionTable table_;  // Q(s, a)
};

}  // namespace gusset
