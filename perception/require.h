#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "base/error.h"

namespace gusset {

/// Farther than this no pixel is: rounding and adding to one cannot overflow.
inline constexpr double kFarthest_px = 1e6;

/// @throws InputError unless the image is a mask: CV_8UC1 and not empty.
inline void RequireMask(const cv::Mat& image, const char* name) {
  if (image.empty()) throw InputError(std::string(name) + " is empty");
  if (image.type() != CV_8UC1) {
    throw InputError(std::string(name) + " has type " + cv::typeToString(image.type()) +
                     ", must be CV_8UC1");
  }
}

/// @throws InputError unless the pixel's coordinates are numbers within kFarthest_px.
template <class Point>
void RequirePixel(const Point& px, const char* name) {
  const auto x = static_cast<double>(px.x), y = static_cast<double>(px.y);
  if (!(std::abs(x) <= kFarthest_px && std::abs(y) <= kFarthest_px)) {
    throw InputError(std::string(name) + " holds (" + std::to_string(x) + ", " + std::to_string(y) +
                     "), which is no pixel");
  }
}

/// @throws InputError unless there are at least `least` points, all of them pixels.
template <class Point>
void RequirePixels(const std::vector<Point>& points, std::size_t least, const char* name) {
  if (points.size() < least) {
    throw InputError(std::string(name) + " has " + std::to_string(points.size()) +
                     " points, needs at least " + std::to_string(least));
  }
  for (const Point& point : points) RequirePixel(point, name);
}

}  // namespace gusset
