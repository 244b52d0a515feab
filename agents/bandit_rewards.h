#pragma once

#include <algorithm>

namespace gusset {

/// What the bagging task pays (docs/loop.md, Actions): -0.1 for a carry that fails, 1 at best.
inline constexpr double kLowestReward = -0.1;
inline constexpr double kHighestReward = 1;

/// A reward on [0, 1], as bandit theory has it. A bag that is stretched or seen askew can cover
/// some percent more than A_bmax, so what lies outside the bounds is cut off.
inline double UnitReward(double reward) {
  return std::clamp((reward - kLowestReward) / (kHighestReward - kLowestReward), 0.0, 1.0);
}

}  // namespace gusset
