#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "perception/config.h"

namespace gusset {

/// A green label on the bag.
struct Label {
  cv::Point2d centroid;  ///< px of the region of interest; weighted by cover.
  double area_px2 = 0;   ///< Sum of cover: parts of pixels count as parts.
};

/// Finds the labels: spots of label colour on the bag that show at least `label_min_px2`, what a
/// sliver's soft edge has lost included. A spot
/// longer than a label is several that touch, as where one layer's label lies beside the other's. A
/// sliver beside a whole label is cut off where that label ends, two larger parts at their waist.
/// How long a spot is follows from its second moment along its longer axis: for a rectangle of
/// length L, L^2/12, and the lens adds little.
/// @param cover ColorMasks::label_cover. @param bag CV_8UC1 mask of the same size.
/// @returns from the largest to the smallest (ties: top to bottom, left to right), at most `most`.
std::vector<Label> FindLabels(const cv::Mat& cover, const cv::Mat& bag, int most,
                              const PerceptionConfig& config);

}  // namespace gusset
