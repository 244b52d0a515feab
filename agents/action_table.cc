#include "agents/action_table.h"

#include <algorithm>
#include <cstdint>
#include <string>

#include "agents/json_fields.h"
#include "base/error.h"

namespace gusset {

int DrawHighest(const std::vector<double>& scores, Rng& rng) {
  const double top = *std::ranges::max_element(scores);
  std::vector<int> ties;
  for (std::size_t a = 0; a < scores.size(); ++a) {
    if (scores[a] == top) ties.push_back(static_cast<int>(a));
  }
  return ties[static_cast<std::size_t>(rng.Below(static_cast<int>(ties.size())))];
}

ActionTable::ActionTable(const std::vector<int>& n_actions) : steps_(n_actions.size()) {
  for (const int n : n_actions) rows_.emplace_back(static_cast<std::size_t>(n));
}

ActionTable::Entry& ActionTable::Count(int state, int action) {
  ++steps_[static_cast<std::size_t>(state)];
  Entry& entry = rows_[static_cast<std::size_t>(state)][static_cast<std::size_t>(action)];
  ++entry.count;
  return entry;
}

int ActionTable::best(int state) const {
  const std::vector<Entry>& row = Row(state);
  return static_cast<int>(std::ranges::max_element(row, {}, &Entry::value) - row.begin());
}

int ActionTable::DrawBest(int state, Rng& rng) const {
  std::vector<double> values;
  for (const Entry& entry : Row(state)) values.push_back(entry.value);
  return DrawHighest(values, rng);
}

std::vector<int> ActionTable::ActionCounts() const {
  std::vector<int> counts;
  for (int s = 0; s < states(); ++s) counts.push_back(actions(s));
  return counts;
}

nlohmann::json ActionTable::Save() const {
  nlohmann::json saved = nlohmann::json::array();
  for (int s = 0; s < states(); ++s) {
    nlohmann::json tried = nlohmann::json::array();
    for (int a = 0; a < actions(s); ++a) {
      const Entry& entry = at(s, a);
      if (entry.count == 0) continue;
      tried.push_back({{"action", a}, {"count", entry.count}, {"value", entry.value}});
    }
    saved.push_back({{"state", s},
                     {"n_actions", actions(s)},
                     {"steps", steps(s)},
                     {"best", best(s)},
                     {"best_value", at(s, best(s)).value},
                     {"tried", tried}});
  }
  return saved;
}

ActionTable ActionTable::Load(const nlohmann::json& object, const std::vector<int>& n_actions,
                              double lo, double hi) {
  constexpr int kMany = std::numeric_limits<int>::max();
  ActionTable table(n_actions);
  const auto saved = JsonField<nlohmann::json::array_t>(object, "states");
  if (saved.size() != n_actions.size()) {
    throw InputError("states has " + std::to_string(saved.size()) + " entries, not " +
                     std::to_string(n_actions.size()));
  }
  for (int s = 0; s < table.states(); ++s) {
    const auto at = static_cast<std::size_t>(s);
    const int n = table.actions(s);
    JsonField<int>(saved[at], "n_actions", n, n);
    table.steps_[at] = JsonField<int>(saved[at], "steps", 0, kMany);
    std::int64_t counted = 0;
    for (const nlohmann::json& tried : JsonField<nlohmann::json::array_t>(saved[at], "tried")) {
      const int action = JsonField<int>(tried, "action", 0, n - 1);
      Entry& entry = table.rows_[at][static_cast<std::size_t>(action)];
      if (entry.count > 0) {
        throw InputError("action = " + std::to_string(action) + " of state " + std::to_string(s) +
                         " is there twice");
      }
      entry = {JsonField<int>(tried, "count", 1, kMany), JsonField<double>(tried, "value", lo, hi)};
      counted += entry.count;
    }
    if (counted != table.steps(s)) {
      throw InputError("steps = " + std::to_string(table.steps(s)) + " of state " +
                       std::to_string(s) + " is not the sum of its counts, " +
                       std::to_string(counted));
    }
    // For people to read; one that was edited would have no effect.
    if (saved[at].contains("best") && JsonField<int>(saved[at], "best") != table.best(s)) {
      throw InputError("best = " + saved[at]["best"].dump() + " of state " + std::to_string(s) +
                       " is not what its values say, " + std::to_string(table.best(s)));
    }
  }
  return table;
}

}  // namespace gusset
