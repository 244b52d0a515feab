#pragma once

#include <array>
#include <string>
#include <vector>

#include "agents/report/run_data.h"

namespace gusset {

/// One value per step over several seeds.
struct Band {
  std::vector<double> mean;
  std::vector<double> low, high;  ///< The lowest and the highest seed.
};

/// Step by step over the series that are long enough: seeds whose run has not ended count as far as
/// they have come.
Band BandOver(const std::vector<std::vector<double>>& series);

/// Runs that differ in nothing but their seed.
struct RunGroup {
  std::string label;  ///< Agent, bag and steps; and whatever else tells it from the others.
  std::vector<const RunData*> runs;  ///< By seed.
};

/// Sorts runs into groups, in the order in which each group's first run is given.
std::vector<RunGroup> GroupRuns(const std::vector<RunData>& runs);

/// Learning curve of one state: the mean of the last kCurveWindow rewards (agents/plots.h), over
/// the group's seeds.
Band LearningCurve(const RunGroup& group, int state);

/// Learnt steps of a state and those that led to a later one, over all seeds.
StateTally TrainingTally(const RunGroup& group, int state);

/// Evaluations of one kind (bag, start, pose, repeats, overrides; of the policy or of random
/// choice) added up over the group's seeds.
std::vector<EvaluationData> PooledEvaluations(const RunGroup& group);

}  // namespace gusset
