#pragma once

#include <opencv2/core.hpp>

#include "perception/config.h"
#include "perception/view.h"

namespace gusset {

/// Which pixels have the colour of what: CV_8UC1, 0 or 255.
struct ColorMasks {
  cv::Mat cloth;  ///< As large as the region of interest.
  cv::Mat label;  ///< As large as the region of interest.
  cv::Mat cube;   ///< As large as the frame: the cube waits outside the region of interest.
};

/// Sorts the pixels by hue, saturation and brightness.
ColorMasks ThresholdColors(const View& view, const PerceptionConfig& config);

}  // namespace gusset
