#pragma once

#include <opencv2/core.hpp>

namespace gusset {

/// One look of an RGB-D camera, depth aligned to colour.
struct RgbdFrame {
  cv::Mat color;  ///< CV_8UC3, BGR as OpenCV has it.
  cv::Mat
      depth_mm;  ///< CV_16UC1, distance along the optical axis in mm; 0: no return. May be empty.
};

}  // namespace gusset
