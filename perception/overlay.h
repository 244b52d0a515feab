#pragma once

#include <opencv2/core.hpp>

#include "perception/observation.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// The region of interest with what perception made of it, drawn like figure 5.2 of the thesis:
/// outlines green, grid lines cyan, points red (drag targets blue), areas, piece and state in
/// white.
/// @param frame what `observation` was made from.
/// @throws InputError if it is another one.
/// @returns BGR, as large as the region of interest.
[[nodiscard]] cv::Mat DrawOverlay(const RgbdFrame& frame, const Observation& observation);

}  // namespace gusset
