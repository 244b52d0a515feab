#include "agents/experiment/trial.h"

#include <chrono>

#include "agents/evaluator.h"
#include "agents/experiment/attempts.h"
#include "agents/json_fields.h"
#include "agents/run_folder.h"
#include "base/files.h"

namespace gusset {
namespace {

StartKind Folded(const CellPlan& cell) {
  return cell.any_pose ? StartKind::kFoldedAnyPose : StartKind::kFolded;
}

StartKind Unfolded(const CellPlan& cell) {
  return cell.any_pose ? StartKind::kUnfoldedAnyPose : StartKind::kUnfolded;
}

TrialRecord RunEpisodes(Workers& workers, const Agent& agent, const TrialPlan& plan,
                        const std::function<bool()>& stop) {
  const bool folded = plan.kind == TrialKind::kFolded;
  const EvaluationResult result =
      Evaluate(workers, agent,
               {.start = folded ? Folded(plan.cell) : Unfolded(plan.cell),
                .episodes = plan.count,
                .seed = plan.evaluation_seed(),
                .max_repeats = plan.cell.max_repeats},
               stop);
  TrialRecord record;
  record.n = {plan.count};
  record.successes = {result.true_successes};
  record.seen = {result.perceived_successes};
  for (const StateTally& tally : result.per_step) {
    record.detail["per_step"].push_back({{"attempts", tally.attempts},
                                         {"successes", tally.successes},
                                         {"episodes_reached", tally.reached},
                                         {"episodes_passed", tally.passed}});
  }
  record.sim_s = result.seconds_sim;
  return record;
}

TrialRecord RunAttempts(Workers& workers, const Agent& agent, const TrialPlan& plan,
                        const std::function<bool()>& stop) {
  AttemptResult result;
  workers.Run({[&](Environment& environment) {
    result = AttemptSteps(environment, agent,
                          {.folded = Folded(plan.cell),
                           .unfolded = Unfolded(plan.cell),
                           .attempts = plan.count,
                           .seed = plan.evaluation_seed()},
                          stop);
  }});
  TrialRecord record;
  for (const StepAttempts& step : result.steps) {
    record.n.push_back(step.attempts);
    record.successes.push_back(step.true_successes);
    record.seen.push_back(step.seen_successes);
    record.detail["rewards"].push_back(step.reward);
    record.detail["own_bags"].push_back(step.own_bags);
  }
  record.detail["actions"] = result.actions;
  record.sim_s = result.sim_s;
  return record;
}

}  // namespace

const char* TrialName(TrialKind kind) {
  switch (kind) {
    case TrialKind::kFolded:
      return "folded";
    case TrialKind::kUnfolded:
      return "unfolded";
    default:
      return "attempts";
  }
}

nlohmann::ordered_json TrialPlan::Key() const {
  return {{"trial", TrialName(kind)},
          {"training", cell.training},
          {"seed", seed},
          {"bag", cell.bag},
          {"pose", cell.any_pose ? "any" : "near"},
          {"max_repeats", cell.max_repeats},
          {"count", count},
          {"evaluation_seed", evaluation_seed()}};
}

TrialRecord RunTrial(Workers& workers, const Agent& agent, const TrialPlan& plan,
                     const std::function<bool()>& stop) {
  const auto start = std::chrono::steady_clock::now();
  TrialRecord record = plan.kind == TrialKind::kAttempts ? RunAttempts(workers, agent, plan, stop)
                                                         : RunEpisodes(workers, agent, plan, stop);
  record.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return record;
}

void WriteTrial(const std::filesystem::path& file, const TrialPlan& plan,
                const TrialRecord& record) {
  nlohmann::ordered_json document = plan.Key();
  document["n"] = record.n;
  document["true_successes"] = record.successes;
  document["perceived_successes"] = record.seen;
  document["detail"] = record.detail;
  document["seconds_wall"] = record.wall_s;
  document["seconds_sim"] = record.sim_s;
  document["versions"] = record.versions;
  WriteFileAtomic(file, JsonText(document));
}

std::optional<TrialRecord> ReadTrial(const std::filesystem::path& file, const TrialPlan& plan) {
  if (!Exists(file)) return std::nullopt;
  const nlohmann::json document = ReadJson(file);
  try {
    const nlohmann::ordered_json wanted = plan.Key();
    for (const auto& [key, value] : wanted.items()) {
      const auto found = JsonField<nlohmann::json>(document, key);
      if (found != nlohmann::json(value)) {
        throw InputError(key + " = " + found.dump() + " is not " + value.dump() +
                         ", as asked for now");
      }
    }
    TrialRecord record;
    const std::size_t entries = plan.kind == TrialKind::kAttempts ? 4 : 1;
    const auto counts = [&](const char* key, std::vector<int>& list) {
      for (const nlohmann::json& one : JsonField<nlohmann::json::array_t>(document, key)) {
        list.push_back(JsonField<int>({{key, one}}, key, 0, plan.count));
      }
      if (list.size() == entries) return;
      throw InputError(std::string(key) + " must have " + std::to_string(entries) + " entries");
    };
    counts("n", record.n);
    counts("true_successes", record.successes);
    counts("perceived_successes", record.seen);
    record.detail = JsonField<nlohmann::json>(document, "detail");
    record.wall_s = JsonField<double>(document, "seconds_wall");
    record.sim_s = JsonField<double>(document, "seconds_sim");
    record.versions = JsonField<nlohmann::json>(document, "versions");
    return record;
  } catch (const InputError& e) {
    throw InputError(file.string() + ": " + e.what());
  }
}

}  // namespace gusset
