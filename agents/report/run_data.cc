#include "agents/report/run_data.h"

#include <algorithm>
#include <array>

#include "agents/json_fields.h"
#include "agents/plots.h"
#include "agents/run_folder.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

// As evaluate has it, so that sums over many fit.
constexpr int kMostEpisodes = 100000;
constexpr int kMostAttempts = 100000000;

StateTally ReadTally(const nlohmann::json& json) {
  StateTally tally;
  tally.attempts = JsonField<int>(json, "attempts", 0, kMostAttempts);
  tally.successes = JsonField<int>(json, "successes", 0, tally.attempts);
  return tally;
}

std::string Choice(const nlohmann::json& json, const std::string& key,
                   const std::array<const char*, 2>& choices) {
  const auto text = JsonField<std::string>(json, key);
  if (std::ranges::find(choices, text) != choices.end()) return text;
  throw InputError(key + " = " + json[key].dump() + " is not one of " + choices[0] + ", " +
                   choices[1]);
}

// Files of before there was such a list have none.
std::string Overrides(const nlohmann::json& json) {
  std::string joined;
  if (!json.contains("overrides")) return joined;
  for (const nlohmann::json& one : JsonField<nlohmann::json::array_t>(json, "overrides")) {
    if (!one.is_string()) throw InputError("overrides: " + one.dump() + " is no text");
    joined += (joined.empty() ? "" : ", ") + one.get<std::string>();
  }
  return joined;
}

EvaluationData ReadEvaluation(const std::filesystem::path& file) {
  const nlohmann::json json = ReadJson(file);
  try {
    EvaluationData data;
    data.bag = JsonField<std::string>(json, "bag");
    data.start = Choice(json, "start", {"folded", "unfolded"});
    data.pose = Choice(json, "pose", {"near", "any"});
    data.random = JsonField<std::string>(json, "policy") == "random";
    data.repeats = JsonField<int>(json, "repeats", 1, kMostEpisodes);
    data.overrides = Overrides(json);
    data.episodes = JsonField<int>(json, "episodes", 1, kMostEpisodes);
    data.true_successes = JsonField<int>(json, "true_successes", 0, data.episodes);
    data.perceived_successes = JsonField<int>(json, "perceived_successes", 0, data.episodes);
    const auto steps = JsonField<nlohmann::json::array_t>(json, "per_step");
    if (steps.size() != data.per_step.size()) {
      throw InputError("per_step has " + std::to_string(steps.size()) + " entries, not 4");
    }
    for (std::size_t s = 0; s < steps.size(); ++s) {
      try {
        data.per_step[s] = ReadTally(steps[s]);
      } catch (const InputError& e) {
        throw InputError("per_step[" + std::to_string(s) + "]." + e.what());
      }
    }
    return data;
  } catch (const InputError& e) {
    throw InputError(file.string() + ": " + e.what());
  }
}

}  // namespace

bool IsRunFolder(const std::filesystem::path& folder) {
  return Exists(folder / "config.toml") && Exists(folder / "steps.jsonl");
}

RunData ReadRun(const std::filesystem::path& folder) {
  RunData run;
  run.folder = folder;
  ConfigTree tree;
  tree.Load(folder / "config.toml");
  tree.Read("train", run.train);
  run.config = FlattenResolved(ReadFile(folder / "config.toml"));
  run.config.erase("train.seed");
  run.config.erase("train.dump");

  for (const LoggedStep& step : ReadLoggedSteps(folder / "steps.jsonl")) {
    ++run.actions;
    run.sim_s += step.sim_s;
    if (!step.learnt) continue;
    const auto s = static_cast<std::size_t>(step.state);
    run.rewards[s].push_back(step.reward);
    ++run.training[s].attempts;
    run.training[s].successes += step.advanced;
  }

  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("evaluation") && name.ends_with(".json")) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  for (const std::filesystem::path& file : files) run.evaluations.push_back(ReadEvaluation(file));
  return run;
}

}  // namespace gusset
