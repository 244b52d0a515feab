#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

namespace gusset {

/// What a checkpoint holds besides the agent: all else of a training run that changes while it goes
/// on. Steps and snapshots are known by the number of the action that made them.
struct TrainingProgress {
  int actions = 0;
  int extra = 0;                        ///< Of these, those that nothing was learnt from.
  std::vector<int> learnt;              ///< Steps per state.
  std::vector<int> extra_for;           ///< Extra actions that filled each state's pool.
  std::vector<std::vector<int>> pools;  ///< Snapshots by the state seen.
  std::vector<int> source_size;         ///< Of the pool before, when filling began; -1: not yet.
  std::vector<int> frozen_size;  ///< Of the pool, when its state's training began; -1: not yet.
  int episode = 0;               ///< Protocol "chain" only, as the two after it.
  int episode_actions = 0;
  int current = -1;      ///< Snapshot; -1: a new start is due.
  int last_learnt = -1;  ///< The last action that was learnt from; both protocols.
  double sim_s = 0;
  std::uint64_t steps_bytes = 0;  ///< Of steps.jsonl and progress.csv that count.
  std::uint64_t progress_bytes = 0;
  std::vector<double> recent;  ///< The last rewards.

  explicit TrainingProgress(std::size_t states);
  nlohmann::json Save() const;
  /// @throws InputError naming what is missing, of another kind, out of bounds or for another
  /// number of states; some of it is loaded then.
  void Load(const nlohmann::json& saved);

 private:
  void CheckBounds() const;
};

}  // namespace gusset
