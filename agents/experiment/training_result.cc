#include "agents/experiment/training_result.h"

#include <algorithm>
#include <numeric>

#include "agents/experiment/intervals.h"
#include "agents/json_fields.h"
#include "agents/replay.h"
#include "agents/run_folder.h"

namespace gusset {

double TrainingResult::reward(int state) const {
  return Mean(rewards[static_cast<std::size_t>(state)]);
}

double TrainingResult::total_reward() const {
  double sum = 0;
  for (const std::vector<double>& of_state : rewards) sum += Mean(of_state);
  return sum;
}

double TrainingResult::curve(int state, int step, int window) const {
  const std::vector<double>& all = rewards[static_cast<std::size_t>(state)];
  return Mean({all.begin() + std::max(0, step - window), all.begin() + step});
}

TrainingResult ReadTrainingResult(const std::filesystem::path& run) {
  TrainingResult result;
  for (const nlohmann::json& line : ReadRunSteps(run)) {
    try {
      const int state = JsonField<int>(line, "state", 0, 3);
      const bool learnt = JsonField<std::string>(line, "kind") == "train";
      if (learnt) {
        result.rewards[static_cast<std::size_t>(state)].push_back(
            JsonField<double>(line, "reward"));
      }
      ++result.actions;
      result.extra_actions += !learnt;
      result.sim_s += JsonField<double>(line, "sim_s");
      result.wall_s += JsonField<double>(line, "wall_s");
    } catch (const InputError& e) {
      throw InputError((run / "steps.jsonl").string() + ":" + std::to_string(result.actions + 1) +
                       ": " + e.what());
    }
  }
  for (const std::vector<double>& of_state : result.rewards) {
    if (!of_state.empty() && of_state.size() == result.rewards.front().size()) continue;
    throw InputError((run / "steps.jsonl").string() +
                     ": lacks learnt steps of some state: each must have as many");
  }
  const nlohmann::json about = ReadJson(run / "run.json");
  if (about.is_object()) result.versions = about.value("versions", nlohmann::json::object());
  return result;
}

}  // namespace gusset
