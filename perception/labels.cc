#include "perception/labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "perception/require.h"
#include "perception/shapes.h"

namespace gusset {
namespace {

/// A pixel that a label covers by a third belongs to its spot: the soft edge of two that lie two
/// pixels apart, and what a sliver one pixel wide leaves of itself.
constexpr int kLeastCover = 85;
/// Spots on either side of a glint are one label if they fill so much of their common hull, and
/// that is no longer than a label with its soft edge. Two labels beside each other filled 0.57 to
/// 0.84 of theirs, those no longer than a label at most 0.74 (tuned 2026-11, 28 pairs in 118
/// rendered frames); a label of 9x8 pixels with two columns missing fills 0.78.
constexpr double kLeastFill = 0.76;
constexpr double kSoftEdge_px = 2;
/// A label covers 56 px^2: 60 at most of 360 single ones, from 65 where two touch (the same
/// frames).
constexpr double kLabelArea_px2 = 64;
/// A blurred image makes labels longer by less than this, and no larger.
constexpr double kBlur_px = 1;

using Contour = std::vector<cv::Point>;

struct Pixel {
  cv::Point2d at;
  double cover;  ///< 0..1.
};

/// Area, centroid and principal axes of a spot.
struct Moments {
  double area = 0;
  cv::Point2d centroid;
  cv::Point2d axis;   ///< Unit vector along the longer principal axis.
  double length = 0;  ///< Of the rectangle with as large a second moment along that axis.
};

Moments MomentsOf(const std::vector<Pixel>& spot) {
  Moments m;
  for (const Pixel& pixel : spot) {
    m.area += pixel.cover;
    m.centroid += pixel.cover * pixel.at;
  }
  if (m.area <= 0) return m;
  m.centroid /= m.area;
  // The soft edge, which noise widens, says nothing about length.
  double weight = 0, xx = 0, xy = 0, yy = 0;
  for (const Pixel& pixel : spot) {
    if (pixel.cover < kLeastCover / 255.) continue;
    const cv::Point2d d = pixel.at - m.centroid;
    weight += pixel.cover;
    xx += pixel.cover * d.x * d.x;
    xy += pixel.cover * d.x * d.y;
    yy += pixel.cover * d.y * d.y;
  }
  if (weight <= 0) return m;
  m.axis = LongerAxis(xx, xy, yy);
  const double largest = 0.5 * (xx + yy + std::hypot(xx - yy, 2 * xy)) / weight;
  m.length = std::sqrt(12 * largest);
  return m;
}

/// Where a spot of several labels is cut: across its longer axis at its waist, the place in its
/// middle half that is narrowest.
std::array<std::vector<Pixel>, 2> CutAtWaist(const std::vector<Pixel>& spot, cv::Point2d axis) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Pixel& pixel : spot) {
    if (pixel.cover < kLeastCover / 255.) continue;
    least = std::min(least, axis.dot(pixel.at));
    most = std::max(most, axis.dot(pixel.at));
  }
  std::vector<double> width(static_cast<std::size_t>(most - least) + 1, 0);
  for (const Pixel& pixel : spot) {
    const double t = axis.dot(pixel.at) - least;
    if (t >= 0 && t < static_cast<double>(width.size())) {
      width[static_cast<std::size_t>(t)] += pixel.cover;
    }
  }
  // Bins of a turned raster alias, so three are weighed together; and what is hardly narrower
  // counts less than being nearer the middle.
  const auto bin = [&](std::size_t k) { return k < width.size() ? width[k] : 0; };
  const double middle = 0.5 * static_cast<double>(width.size() - 1);
  double least_score = std::numeric_limits<double>::infinity();
  std::size_t waist = 0;
  for (std::size_t k = 0; k < width.size(); ++k) {
    const double off = std::abs(static_cast<double>(k) - middle);
    if (off > 0.5 * middle) continue;
    const double score = 0.25 * (bin(k - 1) + 2 * bin(k) + bin(k + 1)) + 0.5 * off;
    if (score >= least_score) continue;
    least_score = score;
    waist = k;
  }
  const double cut = least + static_cast<double>(waist) + 0.5;
  std::array<std::vector<Pixel>, 2> parts;
  for (const Pixel& pixel : spot) parts[axis.dot(pixel.at) < cut ? 0 : 1].push_back(pixel);
  return parts;
}

void AddLabels(const std::vector<Pixel>& spot, const PerceptionConfig& config,
               std::vector<Label>& labels) {
  const Moments moments = MomentsOf(spot);
  if (moments.area < config.label_min_px2) return;
  const bool longer = moments.length > config.label_length_px;
  if ((longer && moments.area > kLabelArea_px2) ||
      moments.length > config.label_length_px + kBlur_px) {
    const auto parts = CutAtWaist(spot, moments.axis);
    if (!parts[0].empty() && !parts[1].empty()) {
      // What is too small to be a label is not part of the other one, either.
      for (const std::vector<Pixel>& part : parts) AddLabels(part, config, labels);
      return;
    }
  }
  labels.push_back({moments.centroid, moments.area});
}

/// What lies together.
struct Spot {
  Contour contour;
  cv::Rect box;    ///< With a margin of one pixel, the soft edge.
  cv::Mat filled;  ///< Mask of the box.
  int pixels = 0;
};

Spot MakeSpot(Contour contour) {
  Spot spot;
  spot.box = cv::boundingRect(contour);
  spot.box -= cv::Point(1, 1);
  spot.box += cv::Size(2, 2);
  spot.filled = FilledContour(contour, spot.box);
  spot.pixels = cv::countNonZero(spot.filled);
  spot.contour = std::move(contour);
  return spot;
}

/// Whether two spots are what a glint or a crease left of one label.
bool AreOne(const Spot& a, const Spot& b, const PerceptionConfig& config) {
  // With a margin of one pixel each, boxes two pixels apart touch.
  if (((a.box + cv::Size(1, 1)) & (b.box + cv::Size(1, 1))).empty()) return false;
  Contour both = a.contour, hull;
  both.insert(both.end(), b.contour.begin(), b.contour.end());
  // Rectangle and hull join pixel centres; half a pixel more all around covers the pixels.
  const cv::Size2f size = cv::minAreaRect(both).size;
  if (std::max(size.width, size.height) + 1 > config.label_length_px + kSoftEdge_px) return false;
  cv::convexHull(both, hull);
  const double area = cv::contourArea(hull) + 0.5 * cv::arcLength(hull, /*closed=*/true) + 1;
  return a.pixels + b.pixels > kLeastFill * area;
}

/// The spot's pixels and those of its soft edge. @param spots all of them.
void AppendPixels(const Spot& spot, const cv::Mat& cover, const cv::Mat& spots,
                  std::vector<Pixel>& pixels) {
  static const cv::Mat kEdge = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::Mat reach;
  cv::dilate(spot.filled, reach, kEdge);
  const cv::Rect seen = spot.box & cv::Rect({0, 0}, cover.size());
  for (int y = seen.y; y < seen.br().y; ++y) {
    for (int x = seen.x; x < seen.br().x; ++x) {
      const cv::Point at(x, y), in_box = at - spot.box.tl();
      const bool of_another = spots.at<uchar>(at) != 0 && spot.filled.at<uchar>(in_box) == 0;
      if (reach.at<uchar>(in_box) == 0 || of_another || cover.at<uchar>(at) == 0) continue;
      pixels.push_back({at, cover.at<uchar>(at) / 255.});
    }
  }
}

}  // namespace

std::vector<Label> FindLabels(const cv::Mat& cover, const cv::Mat& bag, int most,
                              const PerceptionConfig& config) {
  RequireMask(cover, "cover");
  RequireMask(bag, "bag");
  if (cover.size() != bag.size()) throw InputError("cover and bag differ in size");
  const cv::Mat spots = (cover >= kLeastCover) & bag;
  std::vector<Contour> contours;
  cv::findContours(spots, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  std::vector<Spot> found;
  for (Contour& contour : contours) {
    // A speck is no part of a label, and there may be thousands of them.
    if (contour.size() > 2) found.push_back(MakeSpot(std::move(contour)));
  }

  std::vector<Label> labels;
  std::vector<bool> taken(found.size(), false);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (taken[k]) continue;
    bool in_parts = false;
    std::vector<Pixel> pixels;
    AppendPixels(found[k], cover, spots, pixels);
    for (std::size_t j = k + 1; j < found.size(); ++j) {
      if (taken[j] || !AreOne(found[k], found[j], config)) continue;
      taken[j] = true;
      AppendPixels(found[j], cover, spots, pixels);
      in_parts = true;
    }
    if (in_parts) {
      const Moments whole = MomentsOf(pixels);
      if (whole.area >= config.label_min_px2) labels.push_back({whole.centroid, whole.area});
    } else {
      AddLabels(pixels, config, labels);
    }
  }
  std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) {
    return std::tuple(-a.area_px2, a.centroid.y, a.centroid.x) <
           std::tuple(-b.area_px2, b.centroid.y, b.centroid.x);
  });
  if (static_cast<int>(labels.size()) > most) labels.resize(most);
  return labels;
}

}  // namespace gusset
