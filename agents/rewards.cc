#include "agents/rewards.h"

#include <algorithm>
#include <cmath>

#include "agents/bandit_rewards.h"

namespace gusset {
namespace {

double PlacingReward(const Observation& before, const Observation& after,
                     const cv::Point2d& placed_px) {
  if (after.state != State::kFilled || before.opening_radius_px <= 0) return 0;
  const cv::Point2d cube_px = after.cube ? after.cube->px : placed_px;
  const cv::Point2d off = cube_px - before.opening_centre.px;
  return std::max(0.0, 1 - std::hypot(off.x, off.y) / before.opening_radius_px);
}

}  // namespace

double Reward(const Observation& before, const Observation& after, const BagThresholds& thresholds,
              const cv::Point2d& placed_px) {
  switch (before.state) {
    case State::kFolded:
      return after.A_bag / thresholds.A_bmax;
    case State::kUnfolded:
      return after.A_o / thresholds.A_omax;
    case State::kOpen:
      return PlacingReward(before, after, placed_px);
    case State::kFilled:
      return after.state == State::kSuccess ? kHighestReward : kLowestReward;
    default:
      return 0;  // s4 and s5 afford no action
  }
}

}  // namespace gusset
