#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "perception/config.h"

namespace gusset {

/// A green label on the bag.
struct Label {
  cv::Point2d centroid;  ///< px of the region of interest.
  int area_px2 = 0;
};

/// Finds the labels: spots of label colour on the bag, larger than the noise floor. A spot longer
/// than a label is several that touch, as where one layer's label lies beside the other's; it is
/// cut at its waist.
/// @param label_colored, bag CV_8UC1 masks of one size.
/// @returns from the largest to the smallest (ties: top to bottom, left to right), at most `most`.
std::vector<Label> FindLabels(const cv::Mat& label_colored, const cv::Mat& bag, int most,
                              const PerceptionConfig& config);

}  // namespace gusset
