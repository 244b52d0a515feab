#pragma once

#include <string>
#include <vector>

#include "agents/action_table.h"
#include "agents/agent.h"

namespace gusset {

/// Thompson sampling (Thompson 1933): draws a mean reward for every action from what is believed
/// of it and takes the highest. Each state is a bandit of its own.
///
/// The belief is Beta(1 + n x, 1 + n (1 - x)), x the mean of the n rewards mapped from [-0.1, 1] to
/// [0, 1]: the posterior of a Bernoulli arm under a uniform prior, with rewards between 0 and 1
/// counted as parts of a success. (Agrawal and Goyal 2012, algorithm 2, toss a coin of that bias
/// instead, so that their bound holds; with one or two tries per action the coin would drown what
/// the reward says.) It has no settings.
class ThompsonSampling final : public Agent {
 public:
  explicit ThompsonSampling(const std::vector<int>& n_actions) : table_(n_actions) {}

  Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
               Rng& rng) const override;
  void Learn(const Transition& transition) override;
  nlohmann::json Save() const override;
  void Load(const nlohmann::json& saved) override;
  std::string name() const override { return "thompson"; }

  int best(int state) const { return table_.best(state); }
  int count(int state, int action) const { return table_.at(state, action).count; }

 private:
  ActionTable table_;  // mean rewards on [0, 1]
};

/// Draws from the Beta distribution; a, b >= 1.
double DrawBeta(double a, double b, Rng& rng);

}  // namespace gusset
