#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/random.h"

namespace gusset {

/// What tabular learners know: for every action of every state how often it was tried and a value.
class ActionTable {
 public:
  struct Entry {
    int count = 0;  ///< How often the pair was learnt from.
    double value = 0;
  };

  /// @param n_actions how many actions each state affords.
  explicit ActionTable(const std::vector<int>& n_actions);

  int states() const { return static_cast<int>(rows_.size()); }
  int actions(int state) const { return static_cast<int>(Row(state).size()); }
  /// How many transitions were learnt in this state.
  int steps(int state) const { return steps_[static_cast<std::size_t>(state)]; }
  const Entry& at(int state, int action) const {
    return Row(state)[static_cast<std::size_t>(action)];
  }
  /// The entry to be updated, its count (and the state's steps) already raised by one.
  Entry& Count(int state, int action);

  /// The action of the highest value, the lowest index among equals.
  int best(int state) const;
  /// The same, drawn among equals.
  int DrawBest(int state, Rng& rng) const;

  /// An array with one object per state: every action tried with its count and value.
  nlohmann::json Save() const;
  /// @returns the table that `object` holds under "states".
  /// @throws InputError unless it fits `n_actions` and every value lies within [lo, hi].
  static ActionTable Load(const nlohmann::json& object, const std::vector<int>& n_actions,
                          double lo = std::numeric_limits<double>::lowest(),
                          double hi = std::numeric_limits<double>::max());
  std::vector<int> ActionCounts() const;

 private:
  const std::vector<Entry>& Row(int state) const { return rows_[static_cast<std::size_t>(state)]; }
  std::vector<std::vector<Entry>> rows_;
  std::vector<int> steps_;
};

/// Draws one of the indices at which `scores` is highest.
int DrawHighest(const std::vector<double>& scores, Rng& rng);

}  // namespace gusset
