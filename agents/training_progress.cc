#include "agents/training_progress.h"

#include <limits>
#include <string>

#include "agents/json_fields.h"
#include "base/error.h"

namespace gusset {
namespace {

// Through JsonField, which names what is missing and refuses numbers that do not fit.
template <class T>
T Field(const T&, const nlohmann::json& object, const std::string& key) {
  return JsonField<T>(object, key);
}
template <class T>
std::vector<T> Field(const std::vector<T>&, const nlohmann::json& object, const std::string& key) {
  std::vector<T> values;
  for (const nlohmann::json& element : JsonField<nlohmann::json::array_t>(object, key)) {
    const std::string name = key + "[" + std::to_string(values.size()) + "]";
    values.push_back(Field(T(), {{name, element}}, name));
  }
  return values;
}

}  // namespace

TrainingProgress::TrainingProgress(std::size_t states)
    : learnt(states),
      extra_for(states),
      pools(states),
      source_size(states, -1),
      frozen_size(states, -1) {}

nlohmann::json TrainingProgress::Save() const {
  return {{"actions", actions},
          {"extra", extra},
          {"learnt", learnt},
          {"extra_for", extra_for},
          {"pools", pools},
          {"source_size", source_size},
          {"frozen_size", frozen_size},
          {"episode", episode},
          {"current", current},
          {"last_learnt", last_learnt},
          {"episode_actions", episode_actions},
          {"sim_s", sim_s},
          {"steps_bytes", steps_bytes},
          {"progress_bytes", progress_bytes},
          {"recent", recent}};
}

void TrainingProgress::Load(const nlohmann::json& saved) {
  const auto get = [&](const char* key, auto& value) { value = Field(value, saved, key); };
  const std::size_t states = learnt.size();
  get("actions", actions);
  get("extra", extra);
  get("learnt", learnt);
  get("extra_for", extra_for);
  get("pools", pools);
  get("source_size", source_size);
  get("frozen_size", frozen_size);
  get("episode", episode);
  get("episode_actions", episode_actions);
  get("current", current);
  get("last_learnt", last_learnt);
  get("sim_s", sim_s);
  get("steps_bytes", steps_bytes);
  get("progress_bytes", progress_bytes);
  get("recent", recent);
  for (const std::size_t size :
       {learnt.size(), extra_for.size(), pools.size(), source_size.size(), frozen_size.size()}) {
    if (size != states) throw InputError("is for another number of states");
  }
  CheckBounds();
}

// Of what is used as an index or a count.
void TrainingProgress::CheckBounds() const {
  const auto within = [](const std::string& name, int value, int lo, int hi) {
    if (value >= lo && value <= hi) return;
    throw InputError(name + " = " + std::to_string(value) + " is not within [" +
                     std::to_string(lo) + ", " + std::to_string(hi) + "]");
  };
  constexpr int kMost = std::numeric_limits<int>::max();
  within("actions", actions, 0, kMost);
  if (sim_s < 0) throw InputError("sim_s is below 0");
  within("extra", extra, 0, actions);
  within("episode", episode, 0, actions);
  within("episode_actions", episode_actions, 0, actions);
  within("current", current, -1, actions - 1);
  within("last_learnt", last_learnt, -1, actions - 1);
  for (std::size_t s = 0; s < learnt.size(); ++s) {
    const std::string at = "[" + std::to_string(s) + "]";
    const int size = static_cast<int>(pools[s].size());
    within("learnt" + at, learnt[s], 0, actions);
    within("extra_for" + at, extra_for[s], 0, extra);
    for (const int id : pools[s]) within("pools" + at, id, 0, actions - 1);
    within("source_size" + at, source_size[s], -1,
           s == 0 ? -1 : static_cast<int>(pools[s - 1].size()));
    if (frozen_size[s] != -1) within("frozen_size" + at, frozen_size[s], 1, size);
  }
}

}  // namespace gusset
