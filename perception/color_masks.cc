#include "perception/color_masks.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <opencv2/core/hal/intrin.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace gusset {
namespace {

/// Rows that are converted at a time: what is read and written then stays in the cache.
constexpr int kStrip = 16;

/// An HSV range that may wrap through red. Sixteen pixels at a time: cv::inRange takes four times
/// as long, and would run four times over the same pixels.
class HsvRange {
 public:
  HsvRange(const std::vector<double>& min, const std::vector<double>& max)
      : lo_{Level(min[0]), Level(min[1]), Level(min[2])},
        hi_{Level(max[0]), Level(max[1]), Level(max[2])} {}

  /// No pixel darker than this belongs.
  void RaiseLeastValue(double v) { lo_[2] = std::max(lo_[2], Level(v)); }

  bool Holds(uchar h, uchar s, uchar v) const {
    const bool from = h >= lo_[0];
    const bool to = h <= hi_[0];
    return (lo_[0] <= hi_[0] ? from && to : from || to) && s >= lo_[1] && s <= hi_[1] &&
           v >= lo_[2] && v <= hi_[2];
  }

  /// 255 where a pixel belongs, else 0.
  cv::v_uint8x16 Holds(const cv::v_uint8x16& h, const cv::v_uint8x16& s,
                       const cv::v_uint8x16& v) const {
    const cv::v_uint8x16 from = h >= cv::v_setall_u8(lo_[0]);
    const cv::v_uint8x16 to = h <= cv::v_setall_u8(hi_[0]);
    return (lo_[0] <= hi_[0] ? from & to : from | to) & Between(s, 1) & Between(v, 2);
  }

 private:
  static uchar Level(double value) { return cv::saturate_cast<uchar>(value); }

  cv::v_uint8x16 Between(const cv::v_uint8x16& value, int channel) const {
    return (value >= cv::v_setall_u8(lo_[channel])) & (value <= cv::v_setall_u8(hi_[channel]));
  }

  std::array<uchar, 3> lo_, hi_;
};

/// Where the pixels of one row belong.
struct RowMask {
  const HsvRange* range;
  uchar* mask;
};

void MarkRow(const uchar* hsv, int count, std::initializer_list<RowMask> rows) {
  constexpr int kLanes = cv::v_uint8x16::nlanes;
  int x = 0;
  for (; x + kLanes <= count; x += kLanes) {
    cv::v_uint8x16 h, s, v;
    cv::v_load_deinterleave(hsv + 3 * x, h, s, v);
    for (const RowMask& row : rows) cv::v_store(row.mask + x, row.range->Holds(h, s, v));
  }
  for (; x < count; ++x) {
    const uchar* p = hsv + 3 * x;
    for (const RowMask& row : rows) row.mask[x] = row.range->Holds(p[0], p[1], p[2]) ? 255 : 0;
  }
}

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
  cloth.RaiseLeastValue(over_canvas);

  ColorMasks masks{cv::Mat(view.roi.size(), CV_8UC1), cv::Mat(view.roi.size(), CV_8UC1),
                   cv::Mat(color.size(), CV_8UC1)};
  cv::Mat hsv;
  for (int top = 0; top < color.rows; top += kStrip) {
    const cv::Rect strip(0, top, color.cols, std::min(kStrip, color.rows - top));
    cv::cvtColor(color(strip), hsv, cv::COLOR_BGR2HSV);
    for (int y = 0; y < strip.height; ++y) {
      const int in_roi = top + y - view.roi.y;
      MarkRow(hsv.ptr(y), color.cols, {{&cube, masks.cube.ptr(top + y)}});
      if (in_roi < 0 || in_roi >= view.roi.height) continue;
      MarkRow(hsv.ptr(y) + 3 * view.roi.x, view.roi.width,
              {{&cloth, masks.cloth.ptr(in_roi)}, {&label, masks.label.ptr(in_roi)}});
    }
  }
  return masks;
}

}  // namespace gusset
