#include "perception/color_masks.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace gusset {
namespace {

/// Rows that are converted at a time: what is read and written then stays in the cache.
constexpr int kStrip = 16;

/// An HSV range that may wrap through red.
struct HsvRange {
  cv::Scalar lo, hi;

  HsvRange(const std::vector<double>& min, const std::vector<double>& max)
      : lo(min[0], min[1], min[2]), hi(max[0], max[1], max[2]) {}

  void Mark(const cv::Mat& hsv, cv::Mat mask) const {
    if (lo[0] <= hi[0]) {
      cv::inRange(hsv, lo, hi, mask);
      return;
    }
    cv::Mat below_wrap;
    cv::inRange(hsv, lo, cv::Scalar(179, hi[1], hi[2]), below_wrap);
    cv::inRange(hsv, cv::Scalar(0, lo[1], lo[2]), hi, mask);
    mask |= below_wrap;
  }
};

/// Median V = max(B, G, R) over every second pixel of every second row.
int MedianBrightness(const cv::Mat& bgr) {
  std::array<int, 256> histogram{};
  int count = 0;
  for (int y = 0; y < bgr.rows; y += 2) {
    const auto* row = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < bgr.cols; x += 2, ++count) {
      ++histogram[std::max({row[x][0], row[x][1], row[x][2]})];
    }
  }
  int value = 0;
  for (int seen = histogram[0]; 2 * seen < count; seen += histogram[value]) ++value;
  return value;
}

}  // namespace

ColorMasks ThresholdColors(const View& view, const PerceptionConfig& config) {
  const cv::Mat& color = view.frame.color;
  const HsvRange label(config.label_hsv_min, config.label_hsv_max);
  const HsvRange cube(config.cube_hsv_min, config.cube_hsv_max);
  HsvRange cloth(config.bag_hsv_min, config.bag_hsv_max);
  const double over_canvas =
      std::min(config.bag_over_canvas * MedianBrightness(color(view.roi)), config.bag_v_cap);
  cloth.lo[2] = std::max(cloth.lo[2], over_canvas);

  ColorMasks masks{cv::Mat(view.roi.size(), CV_8UC1), cv::Mat(view.roi.size(), CV_8UC1),
                   cv::Mat(color.size(), CV_8UC1)};
  cv::Mat hsv;
  for (int top = 0; top < color.rows; top += kStrip) {
    const cv::Rect strip(0, top, color.cols, std::min(kStrip, color.rows - top));
    cv::cvtColor(color(strip), hsv, cv::COLOR_BGR2HSV);
    cube.Mark(hsv, masks.cube(strip));
    const cv::Rect seen = strip & view.roi;
    if (seen.empty()) continue;
    const cv::Mat hsv_seen = hsv(seen - strip.tl());
    cloth.Mark(hsv_seen, masks.cloth(seen - view.roi.tl()));
    label.Mark(hsv_seen, masks.label(seen - view.roi.tl()));
  }
  return masks;
}

}  // namespace gusset
