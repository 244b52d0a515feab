#include "agents/q_learning.h"

#include <cassert>
#include <limits>

#include "agents/json_fields.h"
#include "agents/pi_learning.h"

namespace gusset {

QLearning::QLearning(const QLearningConfig& config, const std::vector<int>& n_actions)
    : config_(config), table_(n_actions) {
  ValidateOrThrow("q_learning", config);
}

Decision QLearning::Act(int state, std::span<const double>, int n_actions, Mode mode,
                        Rng& rng) const {
  assert(n_actions == table_.actions(state));
  if (mode == Mode::kGreedy) return {best(state), false, 0};
  const double epsilon =
      FallingEpsilon(config_.epsilon_min, table_.steps(state), config_.steps_per_state);
  if (rng.Uniform() < epsilon) return {rng.Below(n_actions), true, epsilon};
  return {table_.DrawBest(state, rng), false, epsilon};
}

// Q(s, a) += alpha (r + gamma max_a' Q(s', a') - Q(s, a)), the maximum 0 where the episode ends.
void QLearning::Learn(const Transition& t) {
  const bool over = t.done || t.next_state >= table_.states();
  const double next = over ? 0 : table_.at(t.next_state, table_.best(t.next_state)).value;
  ActionTable::Entry& entry = table_.Count(t.state, t.action);
  entry.value += config_.alpha * (t.reward + config_.gamma * next - entry.value);
}

nlohmann::json QLearning::Save() const {
  return {{"alpha", config_.alpha},
          {"gamma", config_.gamma},
          {"epsilon_min", config_.epsilon_min},
          {"steps_per_state", config_.steps_per_state},
          {"states", table_.Save()}};
}

void QLearning::Load(const nlohmann::json& saved) {
  QLearningConfig config;
  config.alpha = JsonField<double>(saved, "alpha");
  config.gamma = JsonField<double>(saved, "gamma");
  config.epsilon_min = JsonField<double>(saved, "epsilon_min");
  config.steps_per_state =
      JsonField<int>(saved, "steps_per_state", 1, std::numeric_limits<int>::max());
  QLearning loaded(config, {});
  loaded.table_ = ActionTable::Load(saved, table_.ActionCounts());
  *this = std::move(loaded);
}

}  // namespace gusset
