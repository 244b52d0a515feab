#include "agents/pi_learning.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "agents/json_fields.h"

namespace gusset {
namespace {

// Pi(s, a) after the m-th reward R of that pair.
double Updated(const std::string& update, double value, double reward, int m) {
  if (update == "published") return (value + reward) / m;  // Eq. 5.9
  if (update == "last") return reward;
  return value + (reward - value) / m;  // the mean of all m rewards
}

}  // namespace

PiLearning::PiLearning(const PiConfig& config, const std::vector<int>& n_actions)
    : config_(config), table_(n_actions) {
  ValidateOrThrow("pi", config);
}

double FallingEpsilon(double epsilon_min, int steps, int steps_per_state) {
  const double done = static_cast<double>(steps) / steps_per_state;
  return std::clamp(epsilon_min + (1 - epsilon_min) * (1 - done), epsilon_min, 1.0);
}

double PiLearning::Epsilon(int state) const {
  return FallingEpsilon(config_.epsilon_min, steps(state), config_.steps_per_state);
}

Decision PiLearning::Act(int state, std::span<const double>, int n_actions, Mode mode,
                         Rng& rng) const {
  assert(n_actions == table_.actions(state));
  if (mode == Mode::kGreedy) return {best(state), false, 0};

  const double epsilon = Epsilon(state);
  if (rng.Uniform() < epsilon) return {rng.Below(n_actions), true, epsilon};
  return {table_.DrawBest(state, rng), false, epsilon};
}

void PiLearning::Learn(const Transition& transition) {
  ActionTable::Entry& entry = table_.Count(transition.state, transition.action);
  entry.value = Updated(config_.update, entry.value, transition.reward, entry.count);
}

nlohmann::json PiLearning::Save() const {
  return {{"update", config_.update},
          {"epsilon_min", config_.epsilon_min},
          {"steps_per_state", config_.steps_per_state},
          {"states", table_.Save()}};
}

void PiLearning::Load(const nlohmann::json& saved) {
  PiConfig config;
  config.update = JsonField<std::string>(saved, "update");
  config.epsilon_min = JsonField<double>(saved, "epsilon_min");
  config.steps_per_state =
      JsonField<int>(saved, "steps_per_state", 1, std::numeric_limits<int>::max());
  PiLearning loaded(config, {});
  loaded.table_ = ActionTable::Load(saved, table_.ActionCounts());
  *this = std::move(loaded);
}

}  // namespace gusset
