#include "perception/labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <tuple>
#include <utility>

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
/// A label of 12 x 14 mm at 577 px per metre.
constexpr double kLabelArea_px2 = 56;
/// Longer than a label and larger than this, or longer by so much (a blurred image makes labels
/// longer, and no larger), a spot is several. Tuned 2026-11 on the bags of odd number of a corpus
/// with varied light, pose and colours (1,708 frames of s1 and s2; docs/perception.md).
constexpr double kSeveralArea_px2 = 57;
constexpr double kBlur_px = 0.8;
/// Single labels may be longer by so much: without it 42 of 7,908 clear frames of a later such
/// corpus are seen wrong, with it 37.
constexpr double kSlack_px = 0.2;
/// What a sliver loses of its area, for the faintest of its soft edge has lost its hue: labels that
/// show 6 to 20 px^2 were seen 1.3 to 1.6 px^2 smaller, whole ones 0.1 (448 labels in 510 frames
/// with varied light and colours; docs/perception.md).
constexpr double kLost_px2 = 1.4;
/// How far beyond a spot's end the canvas is looked for, and how far to either side.
constexpr int kBeyond_px = 4;
constexpr int kAside_px = 3;
/// How much narrower a cut must be per pixel that it is off: off where a whole label ends (tuned
/// likewise), or off the middle, which says little.
constexpr double kOffLabel = 2;
constexpr double kOffMiddle = 0.5;

using Contour = std::vector<cv::Point>;

/// What a label that shows `label_min_px2` is seen with.
double LeastArea(const PerceptionConfig& config) { return config.label_min_px2 - kLost_px2; }

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

/// How a spot's cover is spread along its longer axis, in bins of a pixel.
struct Profile {
  double from;  ///< The first bin's beginning, along the axis.
  std::vector<double> width;
};

Profile ProfileOf(const std::vector<Pixel>& spot, cv::Point2d axis) {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  for (const Pixel& pixel : spot) {
    if (pixel.cover < kLeastCover / 255.) continue;
    least = std::min(least, axis.dot(pixel.at));
    most = std::max(most, axis.dot(pixel.at));
  }
  Profile profile{least, std::vector<double>(static_cast<std::size_t>(most - least) + 1, 0)};
  for (const Pixel& pixel : spot) {
    const double t = axis.dot(pixel.at) - least;
    if (t >= 0 && t < static_cast<double>(profile.width.size())) {
      profile.width[static_cast<std::size_t>(t)] += pixel.cover;
    }
  }
  return profile;
}

/// How many of the bins, in their order, hold so much.
double Reach(const std::vector<double>& bins, double area) {
  double reach = 0;
  for (const double width : bins) {
    if (width >= area) return reach + (area > 0 ? area / width : 0);
    area -= width;
    ++reach;
  }
  return reach;
}

/// Where a spot may be cut, in bins of its profile, and where it probably should be.
struct CutRange {
  double from, to;
  std::array<double, 2> best;
  double off_weight;
};

/// At the place between `from` and `to` that is narrowest.
std::array<std::vector<Pixel>, 2> CutAtWaist(const std::vector<Pixel>& spot, cv::Point2d axis,
                                             const Profile& profile, const CutRange& range) {
  // Bins of a turned raster alias, so three are weighed together; and what is hardly narrower
  // counts less than being where a cut is probable.
  const std::vector<double>& width = profile.width;
  const auto bin = [&](std::size_t k) { return k < width.size() ? width[k] : 0; };
  double least_score = std::numeric_limits<double>::infinity();
  double waist = 0.5 * (range.from + range.to);
  for (std::size_t k = 0; k < width.size(); ++k) {
    const double t = static_cast<double>(k) + 0.5;
    if (t < range.from || t > range.to) continue;
    const double off = std::min(std::abs(t - range.best[0]), std::abs(t - range.best[1]));
    const double score = 0.25 * (bin(k - 1) + 2 * bin(k) + bin(k + 1)) + range.off_weight * off;
    if (score >= least_score) continue;
    least_score = score;
    waist = t;
  }
  std::array<std::vector<Pixel>, 2> parts;
  for (const Pixel& pixel : spot) {
    parts[axis.dot(pixel.at) < profile.from + waist ? 0 : 1].push_back(pixel);
  }
  return parts;
}

/// How many pixels just beyond a spot's end are not of the bag.
int CanvasBeyond(cv::Point2d end, cv::Point2d outward, const cv::Mat& bag) {
  int count = 0;
  for (int k = 0; k <= kBeyond_px; ++k) {
    for (int side = -kAside_px; side <= kAside_px; ++side) {
      const cv::Point2d at = end + k * outward + side * cv::Point2d(-outward.y, outward.x);
      const cv::Point pixel(cvRound(at.x), cvRound(at.y));
      if (!cv::Rect({0, 0}, bag.size()).contains(pixel) || bag.at<uchar>(pixel) == 0) ++count;
    }
  }
  return count;
}

/// A spot of a label and less than half of another: that one is a sliver of the layer behind,
/// beyond the lip of the layer in front, whose label shows whole. So the cut is probably where that
/// one ends, the sliver on the side where the bag ends sooner.
std::array<std::vector<Pixel>, 2> CutOffSliver(const std::vector<Pixel>& spot,
                                               const Moments& moments, const cv::Mat& bag,
                                               double least_area) {
  const Profile profile = ProfileOf(spot, moments.axis);
  const std::vector<double> backwards(profile.width.rbegin(), profile.width.rend());
  const auto bins = static_cast<double>(profile.width.size());
  const double sliver = std::max(least_area, moments.area - kLabelArea_px2);
  CutRange range{Reach(profile.width, least_area),
                 bins - Reach(backwards, least_area),
                 {Reach(profile.width, sliver), bins - Reach(backwards, sliver)},
                 kOffLabel};
  const auto at = [&](double t) {
    return moments.centroid +
           (profile.from + t - moments.axis.dot(moments.centroid)) * moments.axis;
  };
  const int before = CanvasBeyond(at(0), -moments.axis, bag);
  const int after = CanvasBeyond(at(bins - 1), moments.axis, bag);
  if (before > after) range.best[1] = range.best[0];
  if (before < after) range.best[0] = range.best[1];
  return CutAtWaist(spot, moments.axis, profile, range);
}

/// Across the longer axis, in the spot's middle half.
std::array<std::vector<Pixel>, 2> CutInTheMiddle(const std::vector<Pixel>& spot, cv::Point2d axis) {
  const Profile profile = ProfileOf(spot, axis);
  const double middle = 0.5 * static_cast<double>(profile.width.size());
  return CutAtWaist(spot, axis, profile,
                    {0.5 * middle, 1.5 * middle, {middle, middle}, kOffMiddle});
}

void AddLabels(const std::vector<Pixel>& spot, const cv::Mat& bag, const PerceptionConfig& config,
               std::vector<Label>& labels) {
  const auto add = [&](const Moments& m) { labels.push_back({m.centroid, m.area}); };
  const Moments moments = MomentsOf(spot);
  const double least_area = LeastArea(config);
  if (moments.area < least_area) return;
  const bool several =
      moments.length > config.label_length_px + kBlur_px ||
      (moments.length > config.label_length_px + kSlack_px && moments.area > kSeveralArea_px2);
  if (!several) return add(moments);
  if (moments.area > kLabelArea_px2 && moments.area < 1.5 * kLabelArea_px2) {
    for (const auto& part : CutOffSliver(spot, moments, bag, least_area)) {
      add(MomentsOf(part));
    }
    return;
  }
  const auto parts = CutInTheMiddle(spot, moments.axis);
  if (parts[0].empty() || parts[1].empty()) return add(moments);
  // What is too small to be a label is not part of the other one, either.
  for (const std::vector<Pixel>& part : parts) AddLabels(part, bag, config, labels);
}

/// What lies together.
struct Spot {
  Contour contour;
  cv::Rect box;    ///< With a margin of three pixels: the soft edge, and what is beside it.
  cv::Mat filled;  ///< Mask of the box.
  int pixels = 0;
};

Spot MakeSpot(Contour contour) {
  Spot spot;
  spot.box = cv::boundingRect(contour);
  spot.box -= cv::Point(3, 3);
  spot.box += cv::Size(6, 6);
  spot.filled = FilledContour(contour, spot.box);
  spot.pixels = cv::countNonZero(spot.filled);
  spot.contour = std::move(contour);
  return spot;
}

/// Whether two spots are what a glint or a crease left of one label.
bool AreOne(const Spot& a, const Spot& b, const PerceptionConfig& config) {
  // No more than two pixels apart: boxes have a margin of three each.
  if (((a.box - cv::Size(3, 3)) & (b.box - cv::Size(3, 3))).empty()) return false;
  Contour both = a.contour, hull;
  both.insert(both.end(), b.contour.begin(), b.contour.end());
  // Rectangle and hull join pixel centres; half a pixel more all around covers the pixels.
  const cv::Size2f size = cv::minAreaRect(both).size;
  if (std::max(size.width, size.height) + 1 > config.label_length_px + kSoftEdge_px) return false;
  cv::convexHull(both, hull);
  const double area = cv::contourArea(hull) + 0.5 * cv::arcLength(hull, /*closed=*/true) + 1;
  return a.pixels + b.pixels > kLeastFill * area;
}

/// The spot's pixels and those of its soft edge, two pixels wide, or one where another spot is
/// nearer. @param spots all of them.
void AppendPixels(const Spot& spot, const cv::Mat& cover, const cv::Mat& spots,
                  std::vector<Pixel>& pixels) {
  static const cv::Mat kPixel = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  const cv::Rect seen = spot.box & cv::Rect({0, 0}, cover.size());
  const cv::Mat filled = spot.filled(seen - spot.box.tl());
  const cv::Mat others = spots(seen) & ~filled;
  cv::Mat beside, near, far;
  cv::dilate(others, beside, kPixel);
  cv::dilate(filled, near, kPixel);
  cv::dilate(near, far, kPixel);
  const cv::Mat mine = (near & ~others) | (far & ~beside);
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const cv::Point at = seen.tl() + cv::Point(x, y);
      if (mine.at<uchar>(y, x) == 0 || cover.at<uchar>(at) == 0) continue;
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
      // What lies between two parts is the soft edge of both.
      const auto at = [](const Pixel& pixel) { return std::pair(pixel.at.y, pixel.at.x); };
      std::ranges::sort(pixels, {}, at);
      const auto same = [&](const Pixel& a, const Pixel& b) { return at(a) == at(b); };
      pixels.erase(std::unique(pixels.begin(), pixels.end(), same), pixels.end());
      const Moments whole = MomentsOf(pixels);
      if (whole.area >= LeastArea(config)) labels.push_back({whole.centroid, whole.area});
    } else {
      AddLabels(pixels, bag, config, labels);
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
