#include "perception/mouth_by_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>

#include "perception/require.h"
#include "perception/shapes.h"

namespace gusset {
namespace {

// All lengths in px. Tuned 2026-11 on 34 plain frames of seed 31 (docs/perception.md), unless said
// otherwise.

/// A line's width: stitches of 1.2 mm, blurred.
constexpr double kLineSigma = 1.0;
/// Least second derivative, as a share of the brightness around, of what may be a line at all.
constexpr float kLeastRidge = 0.004f;
/// A profile reaches from so far inside the line to so far outside it,
constexpr int kInside = 5, kOutside = 13;
constexpr int kSteps = kInside + kOutside + 1;
/// and is the mean over so many pixels to either side along it.
constexpr int kAlong = 7;
/// Depth steps are measured between means over this much on either side of a place, less a gap,
/// where matching windows see both surfaces.
constexpr int kStepGap = 1, kStepWidth = 3;
/// Height may differ along a hem's width by no more than this share of the step beyond it.
constexpr float kLevelShare = 0.5f;

using Profile = std::array<float, kSteps>;

/// What is seen across a line, from inside to outside.
struct Profiles {
  Profile brightness{};                                ///< Share of the brightness around.
  Profile cover{};                                     ///< Share of pixels on the bag.
  std::array<std::optional<float>, kSteps> height_mm;  ///< Above an arbitrary level.
};

/// The images that a profile is taken of; all of one size.
struct Layers {
  cv::Mat relative;   ///< CV_32FC1, brightness over that around; 1 on average.
  cv::Mat on_bag;     ///< CV_32FC1, 0 or 1.
  cv::Mat height_mm;  ///< CV_32FC1, NaN where there is none; or empty.
};

/// Mean of an image over the mask within a Gaussian window.
cv::Mat MaskedBlur(const cv::Mat& image, const cv::Mat& mask, double sigma) {
  cv::Mat sum, weight;
  cv::GaussianBlur(image.mul(mask), sum, {}, sigma);
  cv::GaussianBlur(mask, weight, {}, sigma);
  return sum / (weight + 1e-3f);
}

Layers Prepare(const cv::Mat& color, const cv::Mat& depth_mm, const cv::Mat& bag,
               const PerceptionConfig& config) {
  static const cv::Mat kSoftEdge = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::Mat grey, inside, weight, brightness;
  cv::transform(color, grey, cv::Matx13f(1 / 3.f, 1 / 3.f, 1 / 3.f));
  grey.convertTo(brightness, CV_32F);
  cv::erode(bag, inside, kSoftEdge, {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
  inside.convertTo(weight, CV_32F, 1 / 255.0);
  // The bag's own edge is no line: what lies beyond it is taken to be as bright as the cloth here.
  MaskedBlur(brightness, weight, 2.5).copyTo(brightness, ~inside);
  Layers layers;
  layers.relative = brightness / (MaskedBlur(brightness, weight, 6) + 1e-3f);
  bag.convertTo(layers.on_bag, CV_32F, 1 / 255.0);
  if (!depth_mm.empty()) {
    depth_mm.convertTo(layers.height_mm, CV_32F, -1);
    cv::Mat missing =
        (depth_mm < config.depth_min_m * 1000) | (depth_mm > config.depth_max_m * 1000);
    layers.height_mm.setTo(std::nanf(""), missing);
  }
  return layers;
}

/// Dark lines: strength and the direction across them at each pixel.
struct Ridges {
  cv::Mat strength;  ///< CV_32FC1, larger second derivative; 0 off the bag.
  cv::Mat across;    ///< CV_32FC2, unit vectors; either sense.
};

Ridges FindRidges(const cv::Mat& relative, const cv::Mat& bag) {
  const cv::Mat second = cv::Mat(cv::Matx13f(1, -2, 1)),
                smooth = cv::Mat(cv::Matx13f(.25f, .5f, .25f));
  const cv::Mat first = cv::Mat(cv::Matx13f(-.5f, 0, .5f));
  cv::Mat soft, xx, xy, yy, inside;
  cv::GaussianBlur(relative, soft, {}, kLineSigma);
  cv::sepFilter2D(soft, xx, CV_32F, second, smooth);
  cv::sepFilter2D(soft, yy, CV_32F, smooth, second);
  cv::sepFilter2D(soft, xy, CV_32F, first, first);
  cv::erode(bag, inside, cv::getStructuringElement(cv::MORPH_RECT, {5, 5}), {-1, -1}, 1,
            cv::BORDER_CONSTANT, 0);
  Ridges ridges{cv::Mat::zeros(bag.size(), CV_32FC1), cv::Mat::zeros(bag.size(), CV_32FC2)};
  for (int y = 0; y < bag.rows; ++y) {
    for (int x = 0; x < bag.cols; ++x) {
      if (inside.at<uchar>(y, x) == 0) continue;
      const float a = xx.at<float>(y, x), b = xy.at<float>(y, x), c = yy.at<float>(y, x);
      const float most = 0.5f * (a + c) + std::hypot(0.5f * (a - c), b);
      if (!(most > 0)) continue;
      const float angle = 0.5f * std::atan2(2 * b, a - c);
      ridges.strength.at<float>(y, x) = most;
      ridges.across.at<cv::Vec2f>(y, x) = {std::cos(angle), std::sin(angle)};
    }
  }
  return ridges;
}

bool IsCrest(const Ridges& ridges, cv::Point at) {
  const float here = ridges.strength.at<float>(at);
  if (here < kLeastRidge) return false;
  const cv::Vec2f across = ridges.across.at<cv::Vec2f>(at);
  const cv::Point step(cvRound(across[0]), cvRound(across[1]));
  return ridges.strength.at<float>(at + step) <= here &&
         ridges.strength.at<float>(at - step) < here;
}

/// The direction across the line around a pixel: strong neighbours count more.
cv::Point2d SmoothAcross(const Ridges& ridges, cv::Point at) {
  constexpr int kReach = 6;
  double xx = 0, xy = 0, yy = 0;
  for (int y = -kReach; y <= kReach; ++y) {
    for (int x = -kReach; x <= kReach; ++x) {
      const cv::Point there = at + cv::Point(x, y);
      const double s = ridges.strength.at<float>(there);
      const cv::Vec2f across = ridges.across.at<cv::Vec2f>(there);
      xx += s * s * across[0] * across[0];
      xy += s * s * across[0] * across[1];
      yy += s * s * across[1] * across[1];
    }
  }
  return LongerAxis(xx, xy, yy);
}

/// Between pixels; the point must lie inside the image.
float Sample(const cv::Mat& image, double x, double y) {
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const auto fx = static_cast<float>(x - column), fy = static_cast<float>(y - row);
  const float* upper = image.ptr<float>(row) + column;
  const float* lower = image.ptr<float>(row + 1) + column;
  return (upper[0] * (1 - fx) + upper[1] * fx) * (1 - fy) +
         (lower[0] * (1 - fx) + lower[1] * fx) * fy;
}

Profiles TakeProfiles(const Layers& layers, cv::Point at, cv::Point2d outward) {
  Profiles profiles;
  for (int k = 0; k < kSteps; ++k) {
    float brightness = 0, cover = 0, height = 0;
    int heights = 0;
    for (int t = -kAlong; t <= kAlong; ++t) {
      const double x = at.x + (k - kInside) * outward.x - t * outward.y;
      const double y = at.y + (k - kInside) * outward.y + t * outward.x;
      brightness += Sample(layers.relative, x, y);
      cover += Sample(layers.on_bag, x, y);
      if (layers.height_mm.empty()) continue;
      const float h = layers.height_mm.at<float>(cvRound(y), cvRound(x));
      if (std::isnan(h)) continue;
      height += h;
      ++heights;
    }
    constexpr float kCount = 2 * kAlong + 1;
    profiles.brightness[k] = brightness / kCount;
    profiles.cover[k] = cover / kCount;
    if (heights >= 3) profiles.height_mm[k] = height / static_cast<float>(heights);
  }
  return profiles;
}

/// Dark in the middle, and about as bright on one side as on the other: a seam, not the shading of
/// a fold.
bool IsStitching(const Profile& brightness, const PerceptionConfig& config) {
  const float inner = (brightness[kInside - 3] + brightness[kInside - 4]) / 2;
  const float outer = (brightness[kInside + 3] + brightness[kInside + 4]) / 2;
  const float dark =
      std::min(brightness[kInside], std::min(brightness[kInside - 1], brightness[kInside + 1]));
  const float dip = std::min(inner, outer) - dark;
  return dip >= config.hem_dip;
}

/// Mean of up to kStepWidth heights from `from` on in direction `sense`.
std::optional<float> MeanHeight(const Profiles& profiles, int from, int sense) {
  float sum = 0;
  int count = 0;
  for (int k = from; count < kStepWidth && k >= 0 && k < kSteps && std::abs(k - from) <= kStepWidth;
       k += sense) {
    if (!profiles.height_mm[k]) continue;
    sum += *profiles.height_mm[k];
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<float>(count);
}

/// How far outside the line the cloth ends, if it does at the hem's width.
std::optional<double> FindEdge(const Profiles& profiles, const PerceptionConfig& config) {
  const int nearest = static_cast<int>(std::ceil(config.hem_min_px));
  const int farthest = static_cast<int>(config.hem_max_px);
  // Where the bag ends.
  for (int k = 1; k <= farthest; ++k) {
    const float here = profiles.cover[kInside + k], before = profiles.cover[kInside + k - 1];
    if (before < 0.5f || here >= 0.5f) continue;
    const double edge = k - 1 + (before - 0.5) / (before - here);
    return edge >= config.hem_min_px ? std::optional(edge) : std::nullopt;
  }
  // Where depth falls most: all at once, from a hem that is level itself.
  float most = 0;
  int edge = 0;
  for (int k = 1; k <= farthest + 2; ++k) {
    const auto inner = MeanHeight(profiles, kInside + k - kStepGap, -1);
    const auto outer = MeanHeight(profiles, kInside + k + kStepGap, 1);
    if (!inner || !outer || *inner - *outer <= most) continue;
    most = *inner - *outer;
    edge = k;
  }
  const auto at_line = MeanHeight(profiles, kInside, 1);
  const auto at_edge = MeanHeight(profiles, kInside + edge - kStepGap, -1);
  if (most >= config.hem_step_mm && edge >= nearest && edge <= farthest && at_line && at_edge &&
      std::abs(*at_line - *at_edge) <= kLevelShare * most) {
    return edge;
  }
  return std::nullopt;
}

std::optional<HemPoint> Judge(const Layers& layers, const Ridges& ridges, cv::Point at,
                              const PerceptionConfig& config) {
  const cv::Point2d across = SmoothAcross(ridges, at);
  for (const double sense : {1.0, -1.0}) {
    const cv::Point2d outward = sense * across;
    const Profiles profiles = TakeProfiles(layers, at, outward);
    if (!IsStitching(profiles.brightness, config)) continue;
    if (const auto edge = FindEdge(profiles, config))
      return HemPoint{cv::Point2d(at), outward, *edge};
  }
  return std::nullopt;
}

}  // namespace

std::vector<HemPoint> FindHem(const cv::Mat& color, const cv::Mat& depth_mm, const cv::Mat& bag,
                              const PerceptionConfig& config) {
  RequireMask(bag, "bag");
  if (color.type() != CV_8UC3) throw InputError("color must be CV_8UC3");
  if (!depth_mm.empty() && depth_mm.type() != CV_16UC1)
    throw InputError("depth_mm must be CV_16UC1");
  if (color.size() != bag.size() || (!depth_mm.empty() && depth_mm.size() != bag.size())) {
    throw InputError("color, depth_mm and bag differ in size");
  }
  // As far as a profile's corner lies from its middle, and a pixel for sampling between pixels.
  constexpr int kMargin = 17;
  static_assert(kMargin * kMargin > kOutside * kOutside + kAlong * kAlong);
  std::vector<HemPoint> hem;
  if (bag.rows <= 2 * kMargin || bag.cols <= 2 * kMargin) return hem;
  const Layers layers = Prepare(color, depth_mm, bag, config);
  const Ridges ridges = FindRidges(layers.relative, bag);
  for (int y = kMargin; y < bag.rows - kMargin; ++y) {
    for (int x = kMargin; x < bag.cols - kMargin; ++x) {
      if (!IsCrest(ridges, {x, y})) continue;
      if (const auto point = Judge(layers, ridges, {x, y}, config)) hem.push_back(*point);
    }
  }
  return hem;
}

namespace {

/// A hem is equally wide all along: px.
constexpr double kSameWidth = 1.5;

/// Points of one piece of hem: no gap larger than `gap_px`, and outward directions within 60
/// degrees of their neighbours'.
std::vector<std::vector<HemPoint>> Pieces(const std::vector<HemPoint>& hem, double gap_px) {
  std::vector<std::vector<HemPoint>> pieces;
  std::vector<bool> taken(hem.size(), false);
  for (std::size_t first = 0; first < hem.size(); ++first) {
    if (taken[first]) continue;
    std::vector<std::size_t> queue = {first};
    taken[first] = true;
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const HemPoint& a = hem[queue[i]];
      // Rows lie one after the other: only those within reach need a look.
      const auto from =
          std::lower_bound(hem.begin(), hem.end(), a.line_px.y - gap_px,
                           [](const HemPoint& p, double y) { return p.line_px.y < y; });
      for (auto j = static_cast<std::size_t>(from - hem.begin());
           j < hem.size() && hem[j].line_px.y <= a.line_px.y + gap_px; ++j) {
        const HemPoint& b = hem[j];
        if (taken[j] || cv::norm(b.line_px - a.line_px) > gap_px ||
            a.outward.dot(b.outward) < 0.5) {
          continue;
        }
        taken[j] = true;
        queue.push_back(j);
      }
    }
    std::vector<double> widths;
    for (const std::size_t i : queue) widths.push_back(hem[i].edge_px);
    std::nth_element(widths.begin(), widths.begin() + widths.size() / 2, widths.end());
    const double width = widths[widths.size() / 2];
    std::vector<HemPoint> piece;
    for (const std::size_t i : queue) {
      if (std::abs(hem[i].edge_px - width) <= kSameWidth) piece.push_back(hem[i]);
    }
    if (2 * piece.size() > queue.size()) pieces.push_back(std::move(piece));
  }
  return pieces;
}

/// A stretch of hem as one label would stand for it.
struct Stretch {
  cv::Point2d px;
  int support = 0;
};

void AddStretches(const std::vector<HemPoint>& piece, const PerceptionConfig& config,
                  std::vector<Stretch>& stretches) {
  std::vector<cv::Point2d> stitches;
  for (const HemPoint& p : piece) stitches.push_back(p.line_px);
  const auto [mean, along, least, most] = FitLine(stitches);
  if (most - least < config.hem_min_length_px) return;
  const int parts = std::max(1, cvRound((most - least) / config.hem_spacing_px));
  std::vector<Stretch> mine(static_cast<std::size_t>(parts));
  for (const HemPoint& p : piece) {
    const double share = (along.dot(p.line_px - mean) - least) / (most - least);
    Stretch& s =
        mine[static_cast<std::size_t>(std::min(parts - 1, static_cast<int>(share * parts)))];
    s.px += p.line_px + std::max(0.0, p.edge_px - config.label_inset_px) * p.outward;
    ++s.support;
  }
  for (Stretch& s : mine) {
    if (s.support < 4) continue;
    s.px /= s.support;
    stretches.push_back(s);
  }
}

}  // namespace

std::vector<cv::Point2d> FindLipPoints(const cv::Mat& color, const cv::Mat& depth_mm,
                                       const cv::Mat& bag, int most,
                                       const PerceptionConfig& config) {
  constexpr double kGap_px = 6;
  std::vector<Stretch> stretches;
  for (const auto& piece : Pieces(FindHem(color, depth_mm, bag, config), kGap_px)) {
    AddStretches(piece, config, stretches);
  }
  std::sort(stretches.begin(), stretches.end(), [](const Stretch& a, const Stretch& b) {
    return std::tuple(-a.support, a.px.y, a.px.x) < std::tuple(-b.support, b.px.y, b.px.x);
  });
  if (static_cast<int>(stretches.size()) > most)
    stretches.resize(static_cast<std::size_t>(std::max(most, 0)));
  std::vector<cv::Point2d> points;
  for (const Stretch& s : stretches) points.push_back(s.px);
  return points;
}

}  // namespace gusset
