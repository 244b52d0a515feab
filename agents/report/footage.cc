#include "agents/report/footage.h"

#include <algorithm>
#include <cstdio>
#include <set>

#include "agents/json_fields.h"
#include "agents/report/dumped_action.h"
#include "agents/run_folder.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

std::string Named(int state) {
  static const char* const names[] = {"s0 folded", "s1 unfolded", "s2 open",
                                      "s3 filled", "s4 success",  "s5 fail"};
  return state < 0 ? "lost" : names[state];
}

std::string Caption(int state, int action, int next) {
  return Named(state) + ", action " + std::to_string(action) + " → " + Named(next);
}

std::string KindOfEpisode(bool success, const std::string& last_outcome, int last_state) {
  if (success) return "success";
  if (last_outcome == "advanced" || last_outcome == "no progress") {
    return "given up in " + Named(last_state);
  }
  return last_outcome;
}

// Adds the look that files of `prefix` show, if they are there.
void AddFrame(Film& film, const std::string& prefix, const std::string& caption) {
  const fs::path picture = prefix + "_overlay.png";
  if (Exists(picture)) film.frames.push_back({picture, caption});
}

// An episode of `play`.
Film ReadPlay(const fs::path& folder) {
  const fs::path file = folder / "episode.json";
  const nlohmann::json json = ReadJson(file);
  try {
    Film film;
    film.source = folder;
    film.success = JsonField<bool>(json, "true_success");
    if (Exists(folder / "episode.mp4")) film.video = folder / "episode.mp4";
    const auto steps = JsonField<nlohmann::json::array_t>(json, "steps");
    film.kind = KindOfEpisode(film.success, "no progress", 0);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const int state = JsonField<int>(steps[i], "state", 0, 3);
      const int action = JsonField<int>(steps[i], "action");
      const int next = JsonField<int>(steps[i], "next_state", 0, 5);
      char name[32];
      std::snprintf(name, sizeof name, "action%02zu", i);
      const std::string prefix = (folder / name).string();
      AddFrame(film, prefix + "_before", Caption(state, action, next));
      if (i + 1 < steps.size()) continue;
      AddFrame(film, prefix + "_after", "at the end: " + Named(next));
      const bool perceived = JsonField<bool>(json, "perceived_success");
      film.kind = KindOfEpisode(film.success,
                                OutcomeName(state, next, next >= 4, perceived, film.success), next);
    }
    return film;
  } catch (const InputError& e) {
    throw InputError(file.string() + ": " + e.what());
  }
}

// What --dump wrote: episodes of an evaluation, or single actions of a training.
std::vector<Film> ReadDump(const fs::path& folder) {
  std::vector<Film> films;
  const std::vector<DumpedAction> actions = ReadDumpedActions(folder);
  for (std::size_t i = 0; i < actions.size(); ++i) {
    const DumpedAction& action = actions[i];
    const bool goes_on = i > 0 && action.episode && action.episode == actions[i - 1].episode;
    if (!goes_on) films.emplace_back().source = folder;
    Film& film = films.back();
    const std::string prefix = action.prefix.string();
    AddFrame(film, prefix + "_before", Caption(action.state, action.action, action.next_state));
    const bool last =
        i + 1 == actions.size() || !action.episode || action.episode != actions[i + 1].episode;
    if (!last) continue;
    AddFrame(film, prefix + "_after",
             "at the end: " + Named(action.next_state) +
                 (action.note.empty() ? "" : " (" + action.note + ")"));
    film.success = action.episode_success.value_or(action.outcome == "success");
    if (!action.episode && !action.disagree && action.outcome == "advanced") {
      films.pop_back();  // nothing to find fault with, and no success of the task either
      continue;
    }
    film.kind = action.episode ? KindOfEpisode(film.success, action.outcome, action.next_state)
                               : "in training: " + Named(action.state) + ", " + action.outcome +
                                     (action.disagree ? ", seen wrongly" : "");
  }
  // What `play --run` filmed.
  if (films.size() == 1 && Exists(folder / "action.mp4")) films[0].video = folder / "action.mp4";
  return films;
}

}  // namespace

std::vector<Film> OneOfEachKind(std::vector<Film> films) {
  std::ranges::stable_sort(
      films, {}, [](const Film& film) { return std::pair(!film.success, film.video.empty()); });
  std::set<std::string> kinds;
  std::erase_if(films, [&](const Film& film) {
    return (film.frames.empty() && film.video.empty()) || !kinds.insert(film.kind).second;
  });
  return films;
}

std::vector<Film> FindFilms(const fs::path& folder) {
  std::vector<fs::path> folders = {folder};
  const auto add_inside = [&](const fs::path& parent, const std::string& ending) {
    if (!IsFolder(parent)) return;
    std::vector<fs::path> inside;
    for (const auto& entry : fs::directory_iterator(parent)) {
      if (entry.is_directory() && entry.path().filename().string().ends_with(ending)) {
        inside.push_back(entry.path());
      }
    }
    std::ranges::sort(inside);
    folders.insert(folders.end(), inside.begin(), inside.end());
  };
  add_inside(folder, "frames");
  add_inside(folder / "frames", "");
  std::vector<Film> films;
  for (const fs::path& one : folders) {
    if (Exists(one / "episode.json")) {
      films.push_back(ReadPlay(one));
    } else if (one.filename().string().ends_with("frames") || Exists(one / kContactSheet)) {
      for (Film& film : ReadDump(one)) films.push_back(std::move(film));
    }
  }
  return OneOfEachKind(std::move(films));
}

}  // namespace gusset
