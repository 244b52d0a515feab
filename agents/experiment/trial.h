#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/experiment/plan.h"
#include "agents/workers.h"

namespace gusset {

/// The ways in which a cell's policy is tried with one seed.
enum class TrialKind {
  kFolded,    ///< Whole episodes from folded bags: the task from step 1.
  kUnfolded,  ///< Whole episodes from unfolded bags: the task from step 2.
  kAttempts,  ///< Every step by itself.
};

/// "folded", "unfolded", "attempts".
const char* TrialName(TrialKind kind);

/// One trial to be done.
struct TrialPlan {
  CellPlan cell;
  TrialKind kind = TrialKind::kFolded;
  int seed = 1;    ///< Of the training whose policy is tried.
  int count = 20;  ///< Episodes, or attempts per step.

  /// Seed of starts and noise (evaluate --seed): apart from training's, the same for all agents, so
  /// that they meet the same bags.
  std::uint64_t evaluation_seed() const { return static_cast<std::uint64_t>(seed) + 1000; }
  /// What the trial's outcome depends on, policy and config apart: kept with it, to be compared.
  nlohmann::ordered_json Key() const;
};

/// How it went. Lists have one entry for episodes, four for attempts.
struct TrialRecord {
  std::vector<int> n;          ///< Episodes, or attempts at each step.
  std::vector<int> successes;  ///< By ground truth.
  std::vector<int> seen;       ///< As the camera saw it.
  nlohmann::ordered_json detail;
  double sim_s = 0;
  double wall_s = 0;
  nlohmann::json versions;
};

/// Performs it. @throws RunError if `stop` becomes true, Interrupted.
TrialRecord RunTrial(Workers& workers, const Agent& agent, const TrialPlan& plan,
                     const std::function<bool()>& stop);

void WriteTrial(const std::filesystem::path& file, const TrialPlan& plan,
                const TrialRecord& record);

/// The record in `file`, if there is one. @throws InputError if it is none, or another trial's.
std::optional<TrialRecord> ReadTrial(const std::filesystem::path& file, const TrialPlan& plan);

}  // namespace gusset
