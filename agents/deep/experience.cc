#include "agents/deep/experience.h"

#include <algorithm>
#include <cmath>

#include "agents/deep/network.h"
#include "agents/json_fields.h"
#include "base/error.h"

namespace gusset {
namespace {

constexpr int kColumns = 6 + 2 * kSeenFeatures;  // of an experience on disk

std::array<float, kSeenFeatures> Seen(std::span<const double> features) {
  std::array<float, kSeenFeatures> seen = {};
  for (std::size_t i = 0; i < std::min(seen.size(), features.size()); ++i) {
    seen[i] = static_cast<float>(features[i]);
  }
  return seen;
}

void Fill(float* row, int state, const std::array<float, kSeenFeatures>& seen, int states) {
  row[state] = 1;
  std::ranges::copy(seen, row + states);
}

template <class T, class Of>
at::Tensor Column(std::span<const Experience> experiences, at::ScalarType type, Of of) {
  const at::Tensor column = at::empty({static_cast<std::int64_t>(experiences.size())}, type);
  std::ranges::transform(experiences, column.data_ptr<T>(), of);
  return column;
}

}  // namespace

Experience ExperienceOf(const Transition& t, int states) {
  const bool over = t.done || t.next_state >= states;
  return {t.state,
          t.action,
          over ? 0 : t.next_state,
          over,
          t.follows,
          static_cast<float>(t.reward),
          Seen(t.features),
          Seen(t.next_features)};
}

at::Tensor Observation(int state, std::span<const double> features, int states) {
  const at::Tensor row = at::zeros({1, states + kSeenFeatures}, at::kFloat);
  Fill(row.data_ptr<float>(), state, Seen(features), states);
  return row;
}

at::Tensor Observations(std::span<const Experience> experiences, int states, bool after) {
  const int width = states + kSeenFeatures;
  const at::Tensor rows =
      at::zeros({static_cast<std::int64_t>(experiences.size()), width}, at::kFloat);
  float* row = rows.data_ptr<float>();
  for (const Experience& e : experiences) {
    Fill(row, after ? e.next_state : e.state, after ? e.next_features : e.features, states);
    row += width;
  }
  return rows;
}

at::Tensor States(std::span<const Experience> experiences, bool after) {
  return Column<std::int64_t>(experiences, at::kLong, [after](const Experience& e) {
    return std::int64_t{after ? e.next_state : e.state};
  });
}

at::Tensor Actions(std::span<const Experience> experiences) {
  return Column<std::int64_t>(experiences, at::kLong,
                              [](const Experience& e) { return std::int64_t{e.action}; });
}

at::Tensor Rewards(std::span<const Experience> experiences) {
  return Column<float>(experiences, at::kFloat, [](const Experience& e) { return e.reward; });
}

at::Tensor GoesOn(std::span<const Experience> experiences) {
  return Column<float>(experiences, at::kFloat,
                       [](const Experience& e) { return e.over ? 0.0f : 1.0f; });
}

at::Tensor ActionMask(const std::vector<int>& n_actions) {
  const int widest = std::ranges::max(n_actions);
  const at::Tensor mask =
      at::zeros({static_cast<std::int64_t>(n_actions.size()), widest}, at::kBool);
  for (std::size_t s = 0; s < n_actions.size(); ++s) {
    std::fill_n(mask.data_ptr<bool>() + s * static_cast<std::size_t>(widest), n_actions[s], true);
  }
  return mask;
}

nlohmann::json SaveExperiences(std::span<const Experience> experiences) {
  const at::Tensor table =
      at::empty({static_cast<std::int64_t>(experiences.size()), kColumns}, at::kFloat);
  float* out = table.data_ptr<float>();
  for (const Experience& e : experiences) {
    for (const int number : {e.state, e.action, e.next_state, int{e.over}, int{e.follows}}) {
      *out++ = static_cast<float>(number);
    }
    *out++ = e.reward;
    out = std::ranges::copy(e.features, out).out;
    out = std::ranges::copy(e.next_features, out).out;
  }
  return SaveTensors({table});
}

std::vector<Experience> LoadExperiences(const nlohmann::json& saved, const std::string& key,
                                        const std::vector<int>& n_actions, std::size_t most) {
  const auto list = JsonField<nlohmann::json::array_t>(saved, key);
  std::int64_t rows = 0;
  if (list.size() == 1 && list[0].is_object()) {
    const nlohmann::json shape = list[0].value("shape", nlohmann::json());
    if (shape.is_array() && !shape.empty() && shape[0].is_number_integer()) rows = shape[0];
  }
  if (rows < 0 || static_cast<std::size_t>(rows) > most) {
    throw InputError(key + " holds more than " + std::to_string(most) + " steps");
  }
  const at::Tensor table = at::empty({rows, kColumns}, at::kFloat);
  LoadTensors(saved, key, {table});

  std::vector<Experience> experiences(static_cast<std::size_t>(rows));
  const float* in = table.data_ptr<float>();
  const auto whole = [&](int bound, std::size_t row) {
    const float number = *in++;
    if (number < 0 || !(number < static_cast<float>(bound)) || number != std::floor(number)) {
      throw InputError(key + " does not fit this agent's states and actions, in step " +
                       std::to_string(row));
    }
    return static_cast<int>(number);
  };
  const int states = static_cast<int>(n_actions.size());
  for (std::size_t i = 0; i < experiences.size(); ++i) {
    Experience& e = experiences[i];
    e.state = whole(states, i);
    e.action = whole(n_actions[static_cast<std::size_t>(e.state)], i);
    e.next_state = whole(states, i);
    e.over = whole(2, i) == 1;
    e.follows = whole(2, i) == 1;
    e.reward = *in++;
    for (float& x : e.features) x = *in++;
    for (float& x : e.next_features) x = *in++;
  }
  return experiences;
}

}  // namespace gusset
