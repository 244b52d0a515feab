#pragma once

#include <string>
#include <vector>

#include "agents/action_table.h"
#include "agents/agent.h"
#include "base/config.h"

namespace gusset {

/// Settings of UCB1. Section [ucb1].
struct Ucb1Config {
  double exploration = 2;  ///< The 2 under the root (Auer et al. 2002); 0: the best mean so far.

  template <class V>
  void Fields(V& v) {
    v("exploration", exploration, Range{0, 100});
  }
};

/// UCB1 (Auer, Cesa-Bianchi, Fischer 2002, figure 1): each state is a bandit of its own, which is
/// how Pi-learning sees the task too, and its table is the same: the mean reward of each action.
class Ucb1 final : public Agent {
 public:
  /// @throws InputError if `config` is out of bounds.
  Ucb1(const Ucb1Config& config, const std::vector<int>& n_actions);

  Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
               Rng& rng) const override;
  void Learn(const Transition& transition) override;
  nlohmann::json Save() const override;
  void Load(const nlohmann::json& saved) override;
  std::string name() const override { return "ucb1"; }

  /// Upper confidence bound of the action's reward, on [0, 1] but for the bonus; infinite where
  /// never tried.
  double Index(int state, int action) const;
  int count(int state, int action) const { return table_.at(state, action).count; }
  int best(int state) const { return table_.best(state); }

 private:
  Ucb1Config config_;
  ActionTable table_;  // mean rewards on [0, 1]
};

}  // namespace gusset
