#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "perception/config.h"

namespace gusset {

/// The bag as one body.
struct BagBody {
  cv::Mat mask;                    ///< CV_8UC1, as large as the region of interest; 255: bag.
  std::vector<cv::Point> contour;  ///< Outer border, px of the region of interest.
  double area_px2 = 0;             ///< Pixels of the mask.
  bool at_border = false;          ///< Cut by the region's edge.
};

/// Finds the bag: the largest connected body within the plausible areas. Creases and the dark mouth
/// are filled (up to hole_max_px2); canvas seen through a loop of cloth is not.
/// @param cloth CV_8UC1, non-zero where a pixel has the colour of cloth, of a label, or of
/// something
///   that lies on the cloth; as large as the region of interest.
/// @returns std::nullopt if nothing is large enough. @throws InputError if cloth is no mask.
std::optional<BagBody> FindBag(const cv::Mat& cloth, const PerceptionConfig& config);

}  // namespace gusset
