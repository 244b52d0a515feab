#include "agents/ucb1.h"

#include <cassert>
#include <cmath>
#include <limits>

#include "agents/bandit_rewards.h"
#include "agents/json_fields.h"

namespace gusset {

Ucb1::Ucb1(const Ucb1Config& config, const std::vector<int>& n_actions)
    : config_(config), table_(n_actions) {
  ValidateOrThrow("ucb1", config);
}

// x_j + sqrt(2 ln n / n_j): mean reward of j, n steps in the state, n_j of them with j.
double Ucb1::Index(int state, int action) const {
  const ActionTable::Entry& entry = table_.at(state, action);
  if (entry.count == 0) return std::numeric_limits<double>::infinity();
  const double n = table_.steps(state);
  return entry.value + std::sqrt(config_.exploration * std::log(n) / entry.count);
}

Decision Ucb1::Act(int state, std::span<const double>, int n_actions, Mode mode, Rng& rng) const {
  assert(n_actions == table_.actions(state));
  if (mode == Mode::kGreedy) return {best(state), false, 0};
  std::vector<double> indices;
  for (int a = 0; a < n_actions; ++a) indices.push_back(Index(state, a));
  return {DrawHighest(indices, rng), false, 0};
}

void Ucb1::Learn(const Transition& t) {
  ActionTable::Entry& entry = table_.Count(t.state, t.action);
  entry.value += (UnitReward(t.reward) - entry.value) / entry.count;
}

nlohmann::json Ucb1::Save() const {
  return {{"exploration", config_.exploration}, {"states", table_.Save()}};
}

void Ucb1::Load(const nlohmann::json& saved) {
  Ucb1 loaded({.exploration = JsonField<double>(saved, "exploration")}, {});
  loaded.table_ = ActionTable::Load(saved, table_.ActionCounts(), 0, 1);
  *this = std::move(loaded);
}

}  // namespace gusset
