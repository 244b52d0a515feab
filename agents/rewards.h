#pragma once

#include "perception/observation.h"

namespace gusset {

/// Eq. 5.10 as it must be meant (docs/loop.md lists where the thesis and its code differ): what an
/// action taken in before.state earned, from what the camera saw before and after it.
///
///   s0: A_bag / A_bmax.  s1: A_o / A_omax.
///   s2: max(0, 1 - d/r) if s3 follows, else 0; d: distance (px) of what shows of the cube after
///       the action from the opening's centre before it, r = sqrt(A_o / pi) before it. A cube that
///       has sunk out of sight is where it was released.
///   s3: +1 if s4 follows, else -0.1.
///
/// @param placed_px where the cube was released; used in s2 only.
double Reward(const Observation& before, const Observation& after, const BagThresholds& thresholds,
              const cv::Point2d& placed_px = {});

}  // namespace gusset
