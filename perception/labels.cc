#include "perception/labels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "perception/require.h"

namespace gusset {
namespace {

using Pixels = std::vector<cv::Point>;

/// Where a spot of several labels is cut: across its longer axis at its waist, the place in its
/// middle half that is narrowest.
std::pair<Pixels, Pixels> CutAtWaist(const Pixels& pixels, const cv::RotatedRect& box) {
  const double turn = box.size.width >= box.size.height ? 0 : 90;
  const double angle = (box.angle + turn) * std::numbers::pi / 180;
  const cv::Point2d axis(std::cos(angle), std::sin(angle));
  std::vector<double> along;
  for (const cv::Point& pixel : pixels) along.push_back(axis.dot(cv::Point2d(pixel)));
  const auto [least, most] = std::ranges::minmax(along);
  std::vector<int> width(static_cast<std::size_t>(most - least) + 1, 0);
  for (const double t : along) ++width[static_cast<std::size_t>(t - least)];

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
  std::pair<Pixels, Pixels> parts;
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    (along[i] < cut ? parts.first : parts.second).push_back(pixels[i]);
  }
  return parts;
}

void AddLabels(const Pixels& pixels, const PerceptionConfig& config, std::vector<Label>& labels) {
  if (static_cast<double>(pixels.size()) < config.label_min_px2) return;
  const cv::RotatedRect box = cv::minAreaRect(pixels);
  // The box joins pixel centres; a pixel more covers the pixels themselves.
  if (std::max(box.size.width, box.size.height) + 1 > config.label_length_px) {
    const auto [first, second] = CutAtWaist(pixels, box);
    if (static_cast<double>(std::min(first.size(), second.size())) >= config.label_min_px2) {
      AddLabels(first, config, labels);
      AddLabels(second, config, labels);
      return;
    }
  }
  cv::Point2d sum(0, 0);
  for (const cv::Point& pixel : pixels) sum += cv::Point2d(pixel);
  labels.push_back({sum / static_cast<double>(pixels.size()), static_cast<int>(pixels.size())});
}

}  // namespace

std::vector<Label> FindLabels(const cv::Mat& label_colored, const cv::Mat& bag, int most,
                              const PerceptionConfig& config) {
  RequireMask(label_colored, "label_colored");
  RequireMask(bag, "bag");
  if (label_colored.size() != bag.size()) throw InputError("label_colored and bag differ in size");
  // Joins the parts of a label that a crease or a noisy pixel divides.
  static const cv::Mat kGap = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::Mat spots;
  cv::morphologyEx(label_colored & bag, spots, cv::MORPH_CLOSE, kGap);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(spots, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);

  std::vector<Label> labels;
  for (const std::vector<cv::Point>& contour : contours) {
    const cv::Rect box = cv::boundingRect(contour);
    if (box.area() < config.label_min_px2) continue;
    cv::Mat spot = cv::Mat::zeros(box.size(), CV_8UC1);
    cv::fillPoly(spot, std::vector<std::vector<cv::Point>>{contour}, 255, cv::LINE_8, 0, -box.tl());
    Pixels pixels;
    cv::findNonZero(spot, pixels);
    for (cv::Point& pixel : pixels) pixel += box.tl();
    AddLabels(pixels, config, labels);
  }
  std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) {
    return std::tuple(-a.area_px2, a.centroid.y, a.centroid.x) <
           std::tuple(-b.area_px2, b.centroid.y, b.centroid.x);
  });
  if (static_cast<int>(labels.size()) > most) labels.resize(most);
  return labels;
}

}  // namespace gusset
