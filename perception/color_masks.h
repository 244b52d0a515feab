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
  /// How much of each pixel of the region of interest a label covers, 0 to 255 for all of it. A
  /// pixel of the lens's soft edge, or one that a sliver of a label runs through, mixes label and
  /// cloth, and its saturation lies as far between theirs. Both are taken from this frame: the
  /// median of cloth's; what three in ten of the label-coloured pixels exceed, since about half of
  /// a label's pixels are its edge.
  cv::Mat label_cover;
};

/// Sorts the pixels by hue, saturation and brightness. Labels are sought on the cloth and a label's
/// length round it, in colours balanced by the cloth's, which takes the light's tint off.
ColorMasks ThresholdColors(const View& view, const PerceptionConfig& config);

}  // namespace gusset
