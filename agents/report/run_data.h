#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "agents/affordances.h"
#include "agents/evaluator.h"
#include "agents/trainer.h"

namespace gusset {

/// One evaluation*.json of a run folder: what `gusset evaluate --out` wrote.
struct EvaluationData {
  std::string bag, start, pose;
  bool random = false;  ///< Of random choice instead of what the run learnt.
  int repeats = 0;      ///< Actions in one state before an episode was given up.
  /// Settings other than the run's (of random choice: than the defaults) that it was measured by,
  /// joined by commas.
  std::string overrides;
  int episodes = 0;
  int true_successes = 0;
  int perceived_successes = 0;
  std::array<StateTally, kActingStates> per_step{};
};

/// What a report needs of a run folder, which may still be written.
struct RunData {
  std::filesystem::path folder;
  TrainConfig train;
  /// config.toml as section.key: value, without what seeds of one curve may differ in (train.seed
  /// and train.dump).
  std::map<std::string, std::string> config;
  /// Per state, of the learnt steps in order.
  std::array<std::vector<double>, kActingStates> rewards;
  /// Per state, learnt steps and those that led to a later state, as the camera saw it.
  std::array<StateTally, kActingStates> training{};
  int actions = 0;  ///< With extra ones.
  double sim_s = 0;
  std::vector<EvaluationData> evaluations;
};

/// True for a folder with config.toml and steps.jsonl.
bool IsRunFolder(const std::filesystem::path& folder);

/// @throws InputError naming file, line and key of what is missing or broken.
RunData ReadRun(const std::filesystem::path& folder);

}  // namespace gusset
