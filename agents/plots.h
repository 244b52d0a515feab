#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "perception/observation.h"

namespace gusset {

/// What plots need of one line of steps.jsonl.
struct LoggedStep {
  int state = 0;
  int point = 0;
  double reward = 0;
  bool learnt = false;    ///< Not an extra action.
  bool fits = true;       ///< The pair is the state's own, so `point` is one of the state's.
  bool advanced = false;  ///< A later state followed, or success, as the camera saw it.
  double sim_s = 0;       ///< Simulated time that the action took.
};

/// Reads steps.jsonl. @throws InputError naming file and line.
std::vector<LoggedStep> ReadLoggedSteps(const std::filesystem::path& file);

/// Rewards that a point of a learning curve is the mean of.
inline constexpr int kCurveWindow = 20;

/// Mean of each value and those before it, `window` at most.
std::vector<double> RunningMean(const std::vector<double>& values, int window);

/// Mean reward of each pose point over all its learnt steps in `state`; NaN for a point not tried.
std::vector<double> MeanRewards(const std::vector<LoggedStep>& steps, int state, int points);

/// Learning curve: for each state the running mean of the last kCurveWindow rewards over its steps.
cv::Mat DrawLearningCurve(const std::vector<LoggedStep>& steps, int states);

/// The region of interest, twice as large, with a disc on every pose point: from blue (the lowest
/// mean reward) to red (the highest), the number beside it; hollow where never tried.
/// @param color  the frame that `seen` was made from.
cv::Mat DrawRewardMap(const cv::Mat& color, const Observation& seen,
                      const std::vector<double>& mean_rewards);

}  // namespace gusset
