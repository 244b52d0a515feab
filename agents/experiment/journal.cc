#include "agents/experiment/journal.h"

#include <spdlog/spdlog.h>

#include <cstdio>

#include "agents/json_fields.h"
#include "base/files.h"
#include "base/random.h"

namespace gusset {
namespace {

// One line of JSON, then the world afterwards.
std::string Written(const Outcome& outcome) {
  const Truth& truth = outcome.truth;
  const nlohmann::ordered_json line = {{"next_state", outcome.next.state},
                                       {"features", outcome.next.features},
                                       {"reward", outcome.reward},
                                       {"done", outcome.done},
                                       {"success", outcome.success},
                                       {"true_success", outcome.true_success},
                                       {"sim_s", outcome.sim_s},
                                       {"layers_held", truth.layers_held},
                                       {"bag_held", truth.bag_held},
                                       {"cube_held", truth.cube_held},
                                       {"cube_in_bag", truth.cube_in_bag},
                                       {"lowest_point_m", truth.lowest_point_m},
                                       {"held_clear_s", truth.held_clear_s},
                                       {"bag_area_px2", truth.bag_area_px2},
                                       {"opening_area_px2", truth.opening_area_px2},
                                       {"state_true", truth.state},
                                       {"log", outcome.log}};
  return line.dump() + "\n" + outcome.after;
}

Outcome Read(const std::filesystem::path& file) {
  const std::string text = ReadFile(file);
  const std::size_t end = text.find('\n');
  try {
    if (end == std::string::npos) throw InputError("has no first line");
    const auto line = nlohmann::ordered_json::parse(text.substr(0, end), nullptr, false);
    const nlohmann::json fields = line;
    Outcome outcome;
    outcome.next.state = JsonField<int>(fields, "next_state");
    for (const nlohmann::json& one : JsonField<nlohmann::json::array_t>(fields, "features")) {
      outcome.next.features.push_back(JsonField<double>({{"features", one}}, "features"));
    }
    outcome.reward = JsonField<double>(fields, "reward");
    outcome.done = JsonField<bool>(fields, "done");
    outcome.success = JsonField<bool>(fields, "success");
    outcome.true_success = JsonField<bool>(fields, "true_success");
    outcome.sim_s = JsonField<double>(fields, "sim_s");
    outcome.truth = {.layers_held = JsonField<int>(fields, "layers_held"),
                     .bag_held = JsonField<bool>(fields, "bag_held"),
                     .cube_held = JsonField<bool>(fields, "cube_held"),
                     .cube_in_bag = JsonField<bool>(fields, "cube_in_bag"),
                     .lowest_point_m = JsonField<double>(fields, "lowest_point_m"),
                     .held_clear_s = JsonField<double>(fields, "held_clear_s"),
                     .bag_area_px2 = JsonField<double>(fields, "bag_area_px2"),
                     .opening_area_px2 = JsonField<double>(fields, "opening_area_px2"),
                     .state = JsonField<int>(fields, "state_true")};
    (void)JsonField<nlohmann::json>(fields, "log");
    outcome.log = line["log"];  // its keys in their order
    outcome.after = text.substr(end + 1);
    return outcome;
  } catch (const InputError& e) {
    throw InputError(file.string() + ": " + e.what());
  }
}

}  // namespace

JournalEnvironment::JournalEnvironment(std::unique_ptr<Environment> environment,
                                       std::filesystem::path folder, std::string actor)
    : environment_(std::move(environment)), folder_(std::move(folder)), actor_(std::move(actor)) {}

Percept JournalEnvironment::Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) {
  world_ = DeriveSeed(DeriveSeed(sensor_seed, actor_), snapshot);
  return environment_->Begin(snapshot, sensor_seed);
}

Outcome JournalEnvironment::Act(int action) {
  char name[40];
  std::snprintf(name, sizeof name, "%016llx.action",
                static_cast<unsigned long long>(
                    DeriveSeed(world_, "action", static_cast<std::uint64_t>(action))));
  const std::filesystem::path file = folder_ / name;
  if (Exists(file)) {
    try {
      return Read(file);
    } catch (const InputError& e) {
      spdlog::warn("{}; the action is done again", e.what());
    }
  }
  Outcome outcome = environment_->Act(action);
  MakeFolder(folder_);
  WriteFileAtomic(file, Written(outcome));
  return outcome;
}

}  // namespace gusset
