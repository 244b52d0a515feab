#include "agents/report/curves.h"

#include <algorithm>
#include <set>
#include <tuple>

#include "agents/experiment/intervals.h"
#include "agents/plots.h"

namespace gusset {
namespace {

std::size_t At(int state) { return static_cast<std::size_t>(state); }

std::string PlainLabel(const RunData& run) {
  return run.train.agent + ", " + run.train.bag + ", " + std::to_string(run.train.steps) +
         " steps per state";
}

// Keys in which the configs of some groups differ, but for those that the plain label names.
std::set<std::string> DifferingKeys(const std::vector<const RunGroup*>& groups) {
  std::set<std::string> keys;
  for (const RunGroup* group : groups) {
    for (const auto& [key, value] : group->runs[0]->config) {
      for (const RunGroup* other : groups) {
        const auto it = other->runs[0]->config.find(key);
        if (it == other->runs[0]->config.end() || it->second != value) keys.insert(key);
      }
    }
  }
  return keys;
}

}  // namespace

Band BandOver(const std::vector<std::vector<double>>& series) {
  Band band;
  for (std::size_t i = 0;; ++i) {
    std::vector<double> values;
    for (const std::vector<double>& one : series) {
      if (i < one.size()) values.push_back(one[i]);
    }
    if (values.empty()) return band;
    const auto [low, high] = std::ranges::minmax(values);
    band.mean.push_back(Mean(values));
    band.low.push_back(low);
    band.high.push_back(high);
  }
}

std::vector<RunGroup> GroupRuns(const std::vector<RunData>& runs) {
  std::vector<RunGroup> groups;
  for (const RunData& run : runs) {
    const auto same = std::ranges::find_if(
        groups, [&](const RunGroup& group) { return group.runs[0]->config == run.config; });
    if (same != groups.end()) {
      same->runs.push_back(&run);
    } else {
      groups.push_back({PlainLabel(run), {&run}});
    }
  }
  std::vector<std::string> labels;
  for (const RunGroup& group : groups) {
    std::vector<const RunGroup*> alike;
    for (const RunGroup& other : groups) {
      if (other.label == group.label) alike.push_back(&other);
    }
    std::string label = group.label;
    for (const std::string& key : DifferingKeys(alike)) {
      const auto it = group.runs[0]->config.find(key);
      label += ", " + key + " = " + (it == group.runs[0]->config.end() ? "(not set)" : it->second);
    }
    labels.push_back(std::move(label));
  }
  for (std::size_t i = 0; i < groups.size(); ++i) {
    groups[i].label = std::move(labels[i]);
    std::ranges::stable_sort(groups[i].runs, {},
                             [](const RunData* run) { return run->train.seed; });
  }
  return groups;
}

Band LearningCurve(const RunGroup& group, int state) {
  std::vector<std::vector<double>> series;
  for (const RunData* run : group.runs) {
    series.push_back(RunningMean(run->rewards[At(state)], kCurveWindow));
  }
  return BandOver(series);
}

StateTally TrainingTally(const RunGroup& group, int state) {
  StateTally sum;
  for (const RunData* run : group.runs) {
    sum.attempts += run->training[At(state)].attempts;
    sum.successes += run->training[At(state)].successes;
  }
  return sum;
}

std::vector<EvaluationData> PooledEvaluations(const RunGroup& group) {
  std::vector<EvaluationData> pooled;
  for (const RunData* run : group.runs) {
    for (const EvaluationData& one : run->evaluations) {
      const auto kind = [](const EvaluationData& e) {
        return std::tie(e.bag, e.start, e.pose, e.random, e.repeats, e.overrides);
      };
      const auto same = std::ranges::find_if(
          pooled, [&](const EvaluationData& other) { return kind(other) == kind(one); });
      if (same == pooled.end()) {
        pooled.push_back(one);
        continue;
      }
      same->episodes += one.episodes;
      same->true_successes += one.true_successes;
      same->perceived_successes += one.perceived_successes;
      for (std::size_t s = 0; s < one.per_step.size(); ++s) {
        same->per_step[s].attempts += one.per_step[s].attempts;
        same->per_step[s].successes += one.per_step[s].successes;
      }
    }
  }
  return pooled;
}

}  // namespace gusset
