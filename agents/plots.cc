#include "agents/plots.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "agents/affordances.h"
#include "agents/json_fields.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

const cv::Scalar kInk(40, 40, 40);
const cv::Scalar kGrid(220, 220, 220);

// One colour per state (Okabe and Ito's palette, told apart by colour-blind readers too), BGR.
cv::Scalar StateColour(int state) {
  static const std::array<cv::Scalar, 4> colours = {
      cv::Scalar(178, 114, 0), {0, 94, 213}, {115, 158, 0}, {167, 121, 204}};
  return colours[static_cast<std::size_t>(state) % colours.size()];
}

void Text(cv::Mat& image, const std::string& text, cv::Point at, double scale = 0.45,
          const cv::Scalar& colour = kInk) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, 1, cv::LINE_AA);
}

// White with a dark rim, for cloth and canvas alike.
void TextOnAnything(cv::Mat& image, const std::string& text, cv::Point at) {
  cv::putText(image, text, at, cv::FONT_HERSHEY_SIMPLEX, 0.45, {0, 0, 0}, 4, cv::LINE_AA);
  Text(image, text, at, 0.45, {255, 255, 255});
}

std::string Number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", x);
  return text;
}

// Blue to red through white.
cv::Scalar Heat(double t) {
  const double cold = std::clamp(2 - 2 * t, 0.0, 1.0);
  const double warm = std::clamp(2 * t, 0.0, 1.0);
  return {255 * cold, 255 * std::min(cold, warm), 255 * warm};
}

constexpr int kLastState = 5;
constexpr double kMostReward = 1e6;  // a frame's area over A_bmax or A_omax, which may be 1
// Far beyond what any state or action has.
constexpr int kMostPoints = 1000;
constexpr double kMostSeconds = 1e6;

}  // namespace

std::vector<LoggedStep> ReadLoggedSteps(const std::filesystem::path& file) {
  std::istringstream lines(ReadFile(file));
  std::vector<LoggedStep> steps;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    try {
      const nlohmann::json json = ParseJson(line);
      JsonField<int>(json, "step", number - 1, number - 1);
      const auto state = JsonField<int>(json, "state", 0, kActingStates - 1);
      LoggedStep step{state, JsonField<int>(json, "point", 0, kMostPoints),
                      JsonField<double>(json, "reward", -kMostReward, kMostReward),
                      JsonField<std::string>(json, "kind") == "train",
                      json.value("pair", state) == state};
      step.advanced = JsonField<bool>(json, "success") ||
                      (!JsonField<bool>(json, "done") &&
                       JsonField<int>(json, "next_state", 0, kLastState) > state);
      step.sim_s = JsonField<double>(json, "sim_s", 0, kMostSeconds);
      steps.push_back(step);
    } catch (const std::exception& e) {
      throw InputError(file.string() + ":" + std::to_string(number) + ": " + e.what());
    }
  }
  return steps;
}

std::vector<double> RunningMean(const std::vector<double>& values, int window) {
  std::vector<double> means;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from =
        i + 1 > static_cast<std::size_t>(window) ? i + 1 - static_cast<std::size_t>(window) : 0;
    double sum = 0;
    for (std::size_t j = from; j <= i; ++j) sum += values[j];
    means.push_back(sum / static_cast<double>(i + 1 - from));
  }
  return means;
}

std::vector<double> MeanRewards(const std::vector<LoggedStep>& steps, int state, int points) {
  std::vector<double> sums(static_cast<std::size_t>(points));
  std::vector<int> counts(sums.size());
  for (const LoggedStep& step : steps) {
    if (!step.learnt || !step.fits || step.state != state || step.point >= points) continue;
    sums[static_cast<std::size_t>(step.point)] += step.reward;
    ++counts[static_cast<std::size_t>(step.point)];
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] = counts[i] > 0 ? sums[i] / counts[i] : std::numeric_limits<double>::quiet_NaN();
  }
  return sums;
}

cv::Mat DrawLearningCurve(const std::vector<LoggedStep>& steps, int states) {
  const cv::Rect box(70, 40, 700, 400);
  cv::Mat image(500, 800, CV_8UC3, cv::Scalar::all(255));

  std::vector<std::vector<double>> curves(static_cast<std::size_t>(states));
  double low = 0;
  double high = 1;
  std::size_t longest = 2;
  for (int s = 0; s < states; ++s) {
    std::vector<double> rewards;
    for (const LoggedStep& step : steps) {
      if (step.learnt && step.state == s) rewards.push_back(step.reward);
    }
    std::vector<double>& curve = curves[static_cast<std::size_t>(s)];
    curve = RunningMean(rewards, kCurveWindow);
    for (const double mean : curve) {
      low = std::min(low, mean);
      high = std::max(high, mean);
    }
    longest = std::max(longest, curve.size());
  }

  const auto at = [&](double step, double reward) {
    const double x = box.x + box.width * step / static_cast<double>(longest - 1);
    const double y = box.y + box.height * (high - reward) / (high - low);
    return cv::Point(cvRound(x), cvRound(y));
  };
  for (int i = 0; i <= 5; ++i) {
    const double reward = low + (high - low) * i / 5;
    const double step = static_cast<double>(longest - 1) * i / 5;
    cv::line(image, at(0, reward), at(static_cast<double>(longest - 1), reward), kGrid);
    Text(image, Number(reward), at(0, reward) + cv::Point(-52, 4));
    Text(image, std::to_string(std::lround(step + 1)), at(step, low) + cv::Point(-10, 20));
  }
  cv::rectangle(image, box, kInk);
  Text(image, "mean of the last " + std::to_string(kCurveWindow) + " rewards", {box.x, 25});
  Text(image, "step in the state", {box.x + box.width / 2 - 60, box.y + box.height + 45});
  for (int s = 0; s < states; ++s) {
    const std::vector<double>& curve = curves[static_cast<std::size_t>(s)];
    for (std::size_t i = 1; i < curve.size(); ++i) {
      cv::line(image, at(static_cast<double>(i - 1), curve[i - 1]),
               at(static_cast<double>(i), curve[i]), StateColour(s), 2, cv::LINE_AA);
    }
    const cv::Point key(box.x + box.width - 220 + 55 * s, 22);
    cv::line(image, key, key + cv::Point(18, 0), StateColour(s), 3);
    Text(image, std::string("s") + std::to_string(s), key + cv::Point(24, 4));
  }
  return image;
}

cv::Mat DrawRewardMap(const cv::Mat& color, const Observation& seen,
                      const std::vector<double>& mean_rewards) {
  constexpr int kScale = 2;
  constexpr double kLeastSpacing_px = 22;  // a disc and its rim
  const std::vector<PosePoint>& points =
      seen.state == State::kOpen ? seen.place_points : seen.grasp_points;
  cv::Mat image;
  cv::resize(color(seen.roi), image, {}, kScale, kScale, cv::INTER_CUBIC);

  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const double mean : mean_rewards) {
    if (std::isnan(mean)) continue;
    low = std::min(low, mean);
    high = std::max(high, mean);
  }
  const std::size_t shown = std::min(points.size(), mean_rewards.size());
  const auto at = [&](std::size_t i) {
    return cv::Point((points[i].px - cv::Point2d(seen.roi.tl())) * kScale);
  };
  // Points may lie too close for numbers and for large discs.
  bool dense = false;
  for (std::size_t i = 0; i < shown; ++i) {
    for (std::size_t j = 0; j < i; ++j) dense = dense || cv::norm(at(i) - at(j)) < kLeastSpacing_px;
  }
  for (std::size_t i = 0; i < shown; ++i) {
    const int radius = dense ? 6 : 11;
    if (!std::isnan(mean_rewards[i])) {
      const double t = high > low ? (mean_rewards[i] - low) / (high - low) : 0.5;
      cv::circle(image, at(i), radius, Heat(t), cv::FILLED, cv::LINE_AA);
    }
    cv::circle(image, at(i), radius, kInk, 1, cv::LINE_AA);
  }
  // By turns above and below: side by side along a rim they would cover one another.
  for (std::size_t i = 0; i < shown && !dense; ++i) {
    if (std::isnan(mean_rewards[i])) continue;
    TextOnAnything(image, Number(mean_rewards[i]), at(i) + cv::Point(-16, i % 2 == 0 ? -16 : 26));
  }
  const std::string range = low <= high ? Number(low) + " to " + Number(high) : "nothing tried";
  Text(image, "s" + std::to_string(static_cast<int>(seen.state)) + "  mean reward " + range,
       {8, 20}, 0.55, {255, 255, 255});
  return image;
}

}  // namespace gusset
