#include "agents/report/dumped_action.h"

#include <algorithm>
#include <tuple>

#include "agents/json_fields.h"
#include "agents/run_folder.h"
#include "base/error.h"

namespace gusset {
namespace {

constexpr int kLastState = 5;
constexpr int kCarryState = 3;
// Actions and steps count from 0; nothing has a million of them.
constexpr int kMost = 1000000;

DumpedAction Read(const std::filesystem::path& file, const nlohmann::json& json) {
  try {
    DumpedAction action;
    action.prefix = file.parent_path() / file.stem();
    action.step = JsonField<int>(json, "step", 0, kMost);
    action.state = JsonField<int>(json, "state", 0, kCarryState);
    action.action = JsonField<int>(json, "action", 0, kMost);
    action.reward = JsonField<double>(json, "reward");
    action.next_state = JsonField<int>(json, "next_state", 0, kLastState);
    action.next_state_true = JsonField<int>(json, "next_state_true", -1, kLastState);
    const bool success = JsonField<bool>(json, "success");
    const bool success_true = JsonField<bool>(json, "success_true");
    action.outcome = OutcomeName(action.state, action.next_state, JsonField<bool>(json, "done"),
                                 success, success_true);
    action.disagree = action.next_state != action.next_state_true || success != success_true;
    if (json.contains("episode")) action.episode = JsonField<int>(json, "episode", 0, kMost);
    if (json.contains("episode_success_true")) {
      action.episode_success = JsonField<bool>(json, "episode_success_true");
    }
    if (json.contains("note")) action.note = JsonField<std::string>(json, "note");
    return action;
  } catch (const InputError& e) {
    throw InputError(file.string() + ": " + e.what());
  }
}

bool TellsOfAction(const nlohmann::json& json) {
  return json.is_object() && json.contains("before") && json.contains("after");
}

bool TellsOfAction(const std::filesystem::path& file) {
  try {
    return TellsOfAction(ReadJson(file));
  } catch (const InputError&) {
    return false;  // somebody's own
  }
}

// As FrameWriter names its pictures.
constexpr const char* kPictures[] = {
    "_before.png", "_before_depth.png", "_before_overlay.png", "_before_masks.png", "_oblique.png",
    "_after.png",  "_after_depth.png",  "_after_overlay.png",  "_after_masks.png"};

}  // namespace

std::string OutcomeName(int state, int next_state, bool done, bool success, bool success_true) {
  if (success_true) return "success";
  if (success) return "false success";
  if (state == kCarryState) return "not carried";
  if (done) return "lost";
  return next_state > state ? "advanced" : "no progress";
}

nlohmann::ordered_json DumpedAction::ToJson() const {
  nlohmann::ordered_json json = {{"name", prefix.filename().string()},
                                 {"step", step},
                                 {"state", state},
                                 {"action", action},
                                 {"reward", reward},
                                 {"next_state", next_state},
                                 {"next_state_true", next_state_true},
                                 {"outcome", outcome},
                                 {"disagree", disagree},
                                 {"note", note}};
  if (episode) json["episode"] = *episode;
  if (episode_success) json["episode_success"] = *episode_success;
  return json;
}

std::vector<DumpedAction> ReadDumpedActions(const std::filesystem::path& folder) {
  std::vector<DumpedAction> actions;
  std::error_code error;
  std::filesystem::directory_iterator entries(folder, error);
  if (error) throw InputError(folder.string() + ": cannot be read: " + error.message());
  for (const auto& entry : entries) {
    if (entry.path().extension() != ".json") continue;
    const nlohmann::json json = ReadJson(entry.path());
    if (!TellsOfAction(json)) continue;
    actions.push_back(Read(entry.path(), json));
  }
  std::ranges::sort(actions, {}, [](const DumpedAction& a) {
    return std::tuple(a.episode.value_or(-1), a.step, a.prefix);
  });
  return actions;
}

void RemoveDumpedActions(const std::filesystem::path& folder, const std::string& begin) {
  std::vector<std::filesystem::path> prefixes;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::filesystem::path& file = entry.path();
    if (file.extension() != ".json" || !file.stem().string().starts_with(begin)) continue;
    if (TellsOfAction(file)) prefixes.push_back(file.parent_path() / file.stem());
  }
  for (const std::filesystem::path& prefix : prefixes) {
    for (const char* picture : kPictures) std::filesystem::remove(prefix.string() + picture);
    // Last, as it is written: what is left by a kill is found again.
    std::filesystem::remove(prefix.string() + ".json");
  }
  std::filesystem::remove(folder / kContactSheet);
}

}  // namespace gusset
