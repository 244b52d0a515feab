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
/// Every so many rows and columns are enough for cloth's median.
constexpr int kSampled = 3;
/// Share of label-coloured pixels that are less saturated than one that is all label.
constexpr double kFullySaturated = 0.7;
/// Fewer pixels than one label has do not show how saturated it is.
constexpr int kPixelsOfALabel = 50;
/// The longer side of a label of 12 x 14 mm, with its soft edge.
constexpr int kLabelLength_px = 10;

/// B, G and R of cotton under the nominal light, as shares of the largest: Bag 1, three rendered
/// frames, 2026-11.
constexpr std::array<double, 3> kCotton = {0.94, 0.99, 1};

/// An HSV range that may wrap through red. Sixteen pixels at a time: cv::inRange takes four times
/// as long, and would run four times over the same pixels.
class HsvRange {
 public:
  HsvRange(const std::vector<double>& min, const std::vector<double>& max)
      : lo_{Level(min[0]), Level(min[1]), Level(min[2])},
        hi_{Level(max[0]), Level(max[1]), Level(max[2])} {}

  /// No pixel darker than this belongs.
  void RaiseLeastValue(double v) { lo_[2] = std::max(lo_[2], Level(v)); }

  int least_value() const { return lo_[2]; }
  /// Where the largest and the smallest of B, G and R differ by less, no pixel belongs.
  int least_chroma() const { return lo_[1] * lo_[2] / 255; }

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

/// Where the pixels of one row belong, or with `saturation` how saturated those are that do.
struct RowMask {
  const HsvRange* range;
  uchar* mask;
  bool saturation = false;
};

void MarkRow(const uchar* hsv, int count, std::initializer_list<RowMask> rows) {
  constexpr int kLanes = cv::v_uint8x16::nlanes;
  int x = 0;
  for (; x + kLanes <= count; x += kLanes) {
    cv::v_uint8x16 h, s, v;
    cv::v_load_deinterleave(hsv + 3 * x, h, s, v);
    for (const RowMask& row : rows) {
      const cv::v_uint8x16 holds = row.range->Holds(h, s, v);
      cv::v_store(row.mask + x, row.saturation ? holds & s : holds);
    }
  }
  for (; x < count; ++x) {
    const uchar* p = hsv + 3 * x;
    for (const RowMask& row : rows) {
      const uchar inside = row.saturation ? p[1] : 255;
      row.mask[x] = row.range->Holds(p[0], p[1], p[2]) ? inside : 0;
    }
  }
}

/// Largest difference between the largest and the smallest of a pixel's B, G and R.
int MostChroma(const cv::Mat& bgr) {
  constexpr int kLanes = cv::v_uint8x16::nlanes;
  cv::v_uint8x16 most = cv::v_setzero_u8();
  int result = 0;
  for (int y = 0; y < bgr.rows; ++y) {
    const uchar* row = bgr.ptr(y);
    int x = 0;
    for (; x + kLanes <= bgr.cols; x += kLanes) {
      cv::v_uint8x16 b, g, r;
      cv::v_load_deinterleave(row + 3 * x, b, g, r);
      most = cv::v_max(most, cv::v_max(cv::v_max(b, g), r) - cv::v_min(cv::v_min(b, g), r));
    }
    for (; x < bgr.cols; ++x) {
      const auto [lo, hi] = std::minmax({row[3 * x], row[3 * x + 1], row[3 * x + 2]});
      result = std::max(result, hi - lo);
    }
  }
  return std::max(result, static_cast<int>(cv::v_reduce_max(most)));
}

/// Calls f with one part of the rectangle after the other, kStrip rows each.
template <class F>
void ForStrips(const cv::Rect& rect, const F& f) {
  for (int top = rect.y; top < rect.br().y; top += kStrip) {
    f(cv::Rect(rect.x, top, rect.width, std::min(kStrip, rect.br().y - top)));
  }
}

/// Columns of a strip outside which every pixel is darker than `least_value` and greyer than
/// `least_chroma`: canvas, which is not worth its conversion.
cv::Range Columns(const cv::Mat& bgr, int least_value, int least_chroma) {
  constexpr int kLanes = cv::v_uint8x16::nlanes;
  if (bgr.cols < kLanes) return {0, bgr.cols};
  const cv::v_uint8x16 value = cv::v_setall_u8(cv::saturate_cast<uchar>(least_value));
  const cv::v_uint8x16 chroma = cv::v_setall_u8(cv::saturate_cast<uchar>(least_chroma));
  const auto is_canvas = [&](int x) {
    cv::v_uint8x16 other = cv::v_setzero_u8();
    for (int y = 0; y < bgr.rows; ++y) {
      cv::v_uint8x16 b, g, r;
      cv::v_load_deinterleave(bgr.ptr(y) + 3 * x, b, g, r);
      const cv::v_uint8x16 most = cv::v_max(cv::v_max(b, g), r);
      other = other | (most >= value) | (most - cv::v_min(cv::v_min(b, g), r) >= chroma);
    }
    return !cv::v_check_any(other);
  };
  cv::Range columns(0, bgr.cols);
  while (columns.start + kLanes <= bgr.cols && is_canvas(columns.start)) columns.start += kLanes;
  if (columns.start + kLanes > bgr.cols) columns.start = bgr.cols - kLanes;
  while (columns.end - kLanes >= columns.start && is_canvas(columns.end - kLanes)) {
    columns.end -= kLanes;
  }
  return columns;
}

using Histogram = std::array<int, 256>;

/// The least value that the share `share` of what was counted does not exceed; 0 for nothing.
int Quantile(const Histogram& histogram, double share) {
  int count = 0;
  for (const int n : histogram) count += n;
  int value = 0;
  for (int seen = histogram[0]; seen < share * count; seen += histogram[value]) ++value;
  return value;
}

/// The first sampled column that is not before `x`.
int FirstSampled(int x) { return (x + kSampled - 1) / kSampled * kSampled; }

/// What a strip's columns and those of the strips above and below it span.
cv::Range WithNeighbours(const std::vector<cv::Range>& strips, std::size_t index) {
  cv::Range all(0, 0);
  for (std::size_t k = index > 0 ? index - 1 : 0; k < std::min(index + 2, strips.size()); ++k) {
    if (strips[k].empty()) continue;
    all = all.empty()
              ? strips[k]
              : cv::Range(std::min(all.start, strips[k].start), std::max(all.end, strips[k].end));
  }
  return all;
}

/// True if there is cloth a label's length from a pixel, on any side: something else of a label's
/// colour, on the canvas, says nothing about labels.
bool IsBesideCloth(const cv::Mat& cloth, int x, int y) {
  for (int dy = -kLabelLength_px; dy <= kLabelLength_px; dy += kLabelLength_px) {
    for (int dx = -kLabelLength_px; dx <= kLabelLength_px; dx += kLabelLength_px) {
      const cv::Point at(x + dx, y + dy);
      if (cv::Rect({0, 0}, cloth.size()).contains(at) && cloth.at<uchar>(at) != 0) return true;
    }
  }
  return false;
}

/// Takes the light's and the cloth's tint off: scales the channels so that cloth has cotton's
/// colour, none brighter than it was. The bag itself is the white card. A pixel that label and
/// tinted cloth share is otherwise less saturated than its share of label (bluish cloth), or of
/// another hue than either. Sixteen values at a time: cv::LUT takes a sixth of perception's time.
class Balance {
 public:
  explicit Balance(const std::array<Histogram, 3>& cloth) {
    std::array<double, 3> gain;
    for (std::size_t k = 0; k < 3; ++k) gain[k] = kCotton[k] / std::max(1, Quantile(cloth[k], 0.5));
    const double largest = std::ranges::max(gain);
    for (std::size_t i = 0; i < share_.size(); ++i) {
      share_[i] = cv::saturate_cast<ushort>(65536 * gain[i % 3] / largest);
    }
  }

  void Apply(const cv::Mat& bgr, cv::Mat& balanced) const {
    balanced.create(bgr.size(), CV_8UC3);
    for (int y = 0; y < bgr.rows; ++y) ApplyRow(bgr.ptr(y), 3 * bgr.cols, balanced.ptr(y));
  }

 private:
  static constexpr int kLanes = cv::v_uint8x16::nlanes;

  void ApplyRow(const uchar* from, int count, uchar* to) const {
    int x = 0;
    for (; x + 3 * kLanes <= count; x += 3 * kLanes) {
      for (int k = 0; k < 3; ++k) {
        cv::v_uint16x8 low, high;
        cv::v_expand(cv::v_load(from + x + k * kLanes), low, high);
        const ushort* share = share_.data() + k * kLanes;
        low = cv::v_mul_hi(low << 8, cv::v_load(share));
        high = cv::v_mul_hi(high << 8, cv::v_load(share + kLanes / 2));
        cv::v_store(to + x + k * kLanes, cv::v_rshr_pack<8>(low, high));
      }
    }
    for (; x < count; ++x) to[x] = Level(from[x], share_[static_cast<std::size_t>(x % 3)]);
  }

  static uchar Level(uchar value, ushort share) {
    return static_cast<uchar>((((value << 8) * static_cast<unsigned>(share) >> 16) + 128) >> 8);
  }

  /// 65536 times a channel's scale, B, G, R and again: for as many values as have whole vectors.
  std::array<ushort, 3 * kLanes> share_;
};

/// From saturation to cover, in place. @param label what is surely label. @param half_covered the
/// saturation of a pixel that a label covers by half, for want of pixels to measure.
void ToCover(const cv::Mat& label, const cv::Mat& cloth, int cloth_saturation, int half_covered,
             cv::Mat& cover) {
  Histogram histogram{};
  int counted = 0;
  const cv::Rect around = cv::boundingRect(label);
  for (int y = around.y; y < around.br().y; ++y) {
    for (int x = around.x; x < around.br().x; ++x) {
      if (label.at<uchar>(y, x) == 0 || !IsBesideCloth(cloth, x, y)) continue;
      ++histogram[cover.at<uchar>(y, x)];
      ++counted;
    }
  }
  int full = Quantile(histogram, kFullySaturated);
  if (counted < kPixelsOfALabel) {
    full = std::max(full, 2 * half_covered - cloth_saturation);
  }
  full = std::max(full, cloth_saturation + 1);
  cv::Mat table(1, 256, CV_8UC1);
  for (int s = 0; s < 256; ++s) {
    table.at<uchar>(s) =
        cv::saturate_cast<uchar>(255. * (s - cloth_saturation) / (full - cloth_saturation));
  }
  cv::LUT(cover, table, cover);
}

/// Median V = max(B, G, R) over every second pixel of every second row.
int MedianBrightness(const cv::Mat& bgr) {
  Histogram histogram{};
  for (int y = 0; y < bgr.rows; y += 2) {
    const auto* row = bgr.ptr<cv::Vec3b>(y);
    for (int x = 0; x < bgr.cols; x += 2) {
      ++histogram[std::max({row[x][0], row[x][1], row[x][2]})];
    }
  }
  return Quantile(histogram, 0.5);
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
  const HsvRange label_hue({config.label_hsv_min[0], 0, config.label_hsv_min[2]},
                           config.label_hsv_max);

  ColorMasks masks{cv::Mat::zeros(view.roi.size(), CV_8UC1),
                   cv::Mat::zeros(view.roi.size(), CV_8UC1), cv::Mat::zeros(color.size(), CV_8UC1),
                   cv::Mat::zeros(view.roi.size(), CV_8UC1)};
  std::array<Histogram, 3> cloth_bgr{};
  cv::Mat hsv;
  std::vector<cv::Range> bright;  // of the region's strips
  const cv::Rect& roi = view.roi;
  ForStrips(roi, [&](const cv::Rect& strip) {
    const cv::Range columns = Columns(color(strip), cloth.least_value(), cube.least_chroma());
    bright.push_back(columns);
    if (columns.empty()) return;
    cv::cvtColor(color(strip).colRange(columns), hsv, cv::COLOR_BGR2HSV);
    for (int y = 0; y < strip.height; ++y) {
      const int row = strip.y + y - roi.y;
      MarkRow(hsv.ptr(y), columns.size(),
              {{&cube, masks.cube.ptr(strip.y + y) + roi.x + columns.start},
               {&cloth, masks.cloth.ptr(row) + columns.start}});
      if (row % kSampled != 0) continue;
      const uchar* is_cloth = masks.cloth.ptr(row);
      const auto* bgr = color.ptr<cv::Vec3b>(strip.y + y) + roi.x;
      for (int x = FirstSampled(columns.start); x < columns.end; x += kSampled) {
        if (is_cloth[x] == 0) continue;
        for (int k = 0; k < 3; ++k) ++cloth_bgr[static_cast<std::size_t>(k)][bgr[x][k]];
      }
    }
  });

  for (const cv::Rect& beside :
       {cv::Rect(0, 0, color.cols, roi.y),
        cv::Rect(0, roi.br().y, color.cols, color.rows - roi.br().y),
        cv::Rect(0, roi.y, roi.x, roi.height),
        cv::Rect(roi.br().x, roi.y, color.cols - roi.br().x, roi.height)}) {
    if (beside.empty()) continue;
    ForStrips(beside, [&](const cv::Rect& strip) {
      // Most of it is canvas, too grey to be worth its conversion.
      if (MostChroma(color(strip)) < cube.least_chroma()) return;
      cv::cvtColor(color(strip), hsv, cv::COLOR_BGR2HSV);
      for (int y = 0; y < strip.height; ++y) {
        MarkRow(hsv.ptr(y), strip.width, {{&cube, masks.cube.ptr(strip.y + y) + strip.x}});
      }
    });
  }

  // Labels lie on the cloth or beside it.
  cv::Rect on_bag = cv::boundingRect(masks.cloth);
  if (on_bag.empty()) return masks;
  on_bag -= cv::Point(kLabelLength_px, kLabelLength_px);
  on_bag += cv::Size(2 * kLabelLength_px, 2 * kLabelLength_px);
  on_bag &= cv::Rect({0, 0}, view.roi.size());

  const Balance balance(cloth_bgr);
  Histogram cloth_saturation{};
  cv::Mat balanced;
  static_assert(kLabelLength_px <= kStrip);
  std::size_t index = 0;
  ForStrips({{0, 0}, roi.size()}, [&](cv::Rect strip) {
    const cv::Range columns = WithNeighbours(bright, index++);
    if (columns.empty()) return;
    strip.x = columns.start - kLabelLength_px;
    strip.width = columns.size() + 2 * kLabelLength_px;
    strip &= on_bag;
    if (strip.empty()) return;
    balance.Apply(color(strip + roi.tl()), balanced);
    cv::cvtColor(balanced, hsv, cv::COLOR_BGR2HSV);
    for (int y = 0; y < strip.height; ++y) {
      const int row = strip.y + y;
      MarkRow(hsv.ptr(y), strip.width,
              {{&label, masks.label.ptr(row) + strip.x},
               {&label_hue, masks.label_cover.ptr(row) + strip.x, /*saturation=*/true}});
      if (row % kSampled != 0) continue;
      const uchar* is_cloth = masks.cloth.ptr(row) + strip.x;
      for (int x = FirstSampled(strip.x) - strip.x; x < strip.width; x += kSampled) {
        if (is_cloth[x] != 0) ++cloth_saturation[hsv.ptr(y)[3 * x + 1]];
      }
    }
  });
  ToCover(masks.label, masks.cloth, Quantile(cloth_saturation, 0.5),
          cv::saturate_cast<uchar>(config.label_hsv_min[1]), masks.label_cover);
  return masks;
}

}  // namespace gusset
