#include "agents/pi_learning.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "agents/json_fields.h"
#include "base/error.h"

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
    : config_(config) {
  ValidateOrThrow("pi", config);
  for (const int n : n_actions) {
    table_.push_back({0, std::vector<Entry>(static_cast<std::size_t>(n))});
  }
}

double PiLearning::Epsilon(int state) const {
  const double done = static_cast<double>(steps(state)) / config_.steps_per_state;
  return std::clamp(config_.epsilon_min + (1 - config_.epsilon_min) * (1 - done),
                    config_.epsilon_min, 1.0);
}

int PiLearning::best(int state) const {
  const std::vector<Entry>& row = table_[static_cast<std::size_t>(state)].entries;
  const auto less = [](const Entry& a, const Entry& b) { return a.value < b.value; };
  return static_cast<int>(std::max_element(row.begin(), row.end(), less) - row.begin());
}

Decision PiLearning::Act(int state, std::span<const double>, [[maybe_unused]] int n_actions,
                         Mode mode, Rng& rng) const {
  const std::vector<Entry>& row = table_[static_cast<std::size_t>(state)].entries;
  assert(n_actions == static_cast<int>(row.size()));
  if (mode == Mode::kGreedy) return {best(state), false, 0};

  const double epsilon = Epsilon(state);
  if (rng.Uniform() < epsilon) {
    return {rng.Below(static_cast<int>(row.size())), true, epsilon};
  }
  const double top = row[static_cast<std::size_t>(best(state))].value;
  std::vector<int> ties;
  for (std::size_t a = 0; a < row.size(); ++a) {
    if (row[a].value == top) ties.push_back(static_cast<int>(a));
  }
  const int pick = rng.Below(static_cast<int>(ties.size()));
  return {ties[static_cast<std::size_t>(pick)], false, epsilon};
}

void PiLearning::Learn(const Transition& transition) {
  Row& row = table_[static_cast<std::size_t>(transition.state)];
  Entry& entry = row.entries[static_cast<std::size_t>(transition.action)];
  ++row.steps;
  ++entry.count;
  entry.value = Updated(config_.update, entry.value, transition.reward, entry.count);
}

nlohmann::json PiLearning::Save() const {
  nlohmann::json states = nlohmann::json::array();
  for (int s = 0; s < static_cast<int>(table_.size()); ++s) {
    nlohmann::json tried = nlohmann::json::array();
    const int n = static_cast<int>(table_[static_cast<std::size_t>(s)].entries.size());
    for (int a = 0; a < n; ++a) {
      if (count(s, a) == 0) continue;
      tried.push_back({{"action", a}, {"count", count(s, a)}, {"value", value(s, a)}});
    }
    states.push_back({{"state", s},
                      {"n_actions", n},
                      {"steps", steps(s)},
                      {"best", best(s)},
                      {"best_value", value(s, best(s))},
                      {"tried", tried}});
  }
  return {{"update", config_.update},
          {"epsilon_min", config_.epsilon_min},
          {"steps_per_state", config_.steps_per_state},
          {"states", states}};
}

void PiLearning::Load(const nlohmann::json& saved) {
  constexpr int kMany = std::numeric_limits<int>::max();
  PiConfig config;
  config.update = JsonField<std::string>(saved, "update");
  config.epsilon_min = JsonField<double>(saved, "epsilon_min");
  config.steps_per_state = JsonField<int>(saved, "steps_per_state", 1, kMany);
  PiLearning loaded(config, {});

  const auto states = JsonField<nlohmann::json::array_t>(saved, "states");
  if (states.size() != table_.size()) {
    throw InputError("states has " + std::to_string(states.size()) + " entries, not " +
                     std::to_string(table_.size()));
  }
  for (std::size_t s = 0; s < table_.size(); ++s) {
    const int n = static_cast<int>(table_[s].entries.size());
    JsonField<int>(states[s], "n_actions", n, n);
    Row row{JsonField<int>(states[s], "steps", 0, kMany),
            std::vector<Entry>(static_cast<std::size_t>(n))};
    for (const nlohmann::json& tried : JsonField<nlohmann::json::array_t>(states[s], "tried")) {
      Entry& entry =
          row.entries[static_cast<std::size_t>(JsonField<int>(tried, "action", 0, n - 1))];
      entry = {JsonField<int>(tried, "count", 1, kMany), JsonField<double>(tried, "value")};
    }
    loaded.table_.push_back(std::move(row));
  }
  *this = std::move(loaded);
}

}  // namespace gusset
