#include "agents/replay.h"

#include <sstream>

#include "agents/json_fields.h"
#include "agents/run_folder.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {

namespace {

// A line with all that doing its action again takes.
nlohmann::json CheckedStep(nlohmann::json step, int number) {
  JsonField<int>(step, "step", number, number);
  JsonField<int>(step, "state");
  JsonField<int>(step, "action");
  JsonField<std::uint64_t>(step, "sensor_seed");
  if (step.contains("reward")) JsonField<double>(step, "reward");
  const auto from = JsonField<nlohmann::json>(step, "from");
  if (from.contains("seed")) {
    JsonField<std::uint64_t>(from, "seed");
  } else {
    JsonField<int>(from, "step", 0, number - 1);
  }
  return step;
}

}  // namespace

std::vector<nlohmann::json> ReadRunSteps(const std::filesystem::path& run) {
  std::vector<nlohmann::json> steps;
  const std::filesystem::path file = run / "steps.jsonl";
  std::istringstream lines(ReadFile(file));
  for (std::string line; std::getline(lines, line);) {
    try {
      steps.push_back(CheckedStep(ParseJson(line), static_cast<int>(steps.size())));
    } catch (const std::exception& e) {
      throw InputError(file.string() + ":" + std::to_string(steps.size() + 1) + ": " + e.what());
    }
  }
  const std::filesystem::path failed = run / "failed_step.json";
  if (Exists(failed)) {
    const nlohmann::json step = ReadJson(failed);
    const int next = static_cast<int>(steps.size());
    try {
      if (JsonField<int>(step, "step") == next) steps.push_back(CheckedStep(step, next));
    } catch (const InputError& e) {
      throw InputError(failed.string() + ": " + e.what());
    }
  }
  return steps;
}

Snapshot WorldBefore(Environment& environment, const std::vector<nlohmann::json>& steps, int step) {
  if (step < 0 || step >= static_cast<int>(steps.size())) {
    throw InputError("step " + std::to_string(step) + " is not within [0, " +
                     std::to_string(static_cast<int>(steps.size()) - 1) + "]");
  }
  const auto from = JsonField<nlohmann::json>(steps[static_cast<std::size_t>(step)], "from");
  if (from.contains("seed")) {
    return environment.Start(StartKind::kFolded, JsonField<std::uint64_t>(from, "seed"));
  }
  const int earlier = JsonField<int>(from, "step", 0, step - 1);
  const nlohmann::json& line = steps[static_cast<std::size_t>(earlier)];
  const Snapshot snapshot = WorldBefore(environment, steps, earlier);
  const Percept percept =
      environment.Begin(snapshot, JsonField<std::uint64_t>(line, "sensor_seed"));
  const std::vector<int> n_actions = environment.ActionCounts();
  const auto state = static_cast<std::size_t>(percept.state);
  if (state >= n_actions.size()) {
    throw RunError("step " + std::to_string(earlier) +
                   " does not come out as logged: the bag is in s" + std::to_string(percept.state));
  }
  return environment.Act(JsonField<int>(line, "action", 0, n_actions[state] - 1)).after;
}

}  // namespace gusset
