#include "perception/mouth_outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "perception/require.h"
#include "perception/shapes.h"

namespace gusset {
namespace {

// Sides shorter by less than this are equal: rounding alone must not make 2-opt turn for ever.
constexpr double kEqual_px = 1e-9;

std::vector<cv::Point2d> Hull(const std::vector<cv::Point2d>& points) {
  const std::vector<cv::Point2f> floats(points.begin(), points.end());
  std::vector<int> corners;
  cv::convexHull(floats, corners, /*clockwise=*/false, /*returnPoints=*/false);
  std::vector<cv::Point2d> hull;
  for (const int corner : corners) hull.push_back(points[static_cast<std::size_t>(corner)]);
  return hull;
}

// Puts a point into the way where that lengthens it least; ties by order.
void Insert(const std::vector<cv::Point2d>& points, std::vector<cv::Point2d>& way) {
  std::vector<cv::Point2d> left;
  for (const cv::Point2d& p : points) {
    if (std::find(way.begin(), way.end(), p) == way.end()) left.push_back(p);
  }
  while (!left.empty()) {
    std::size_t best_point = 0, best_side = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < left.size(); ++i) {
      for (std::size_t j = 0; j < way.size(); ++j) {
        const cv::Point2d &a = way[j], &b = way[(j + 1) % way.size()];
        const double more = cv::norm(left[i] - a) + cv::norm(b - left[i]) - cv::norm(b - a);
        if (more < least) {
          least = more;
          best_point = i;
          best_side = j;
        }
      }
    }
    way.insert(way.begin() + static_cast<std::ptrdiff_t>(best_side) + 1, left[best_point]);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best_point));
  }
}

// Takes the first pair of sides that are longer than the pair of the same corners joined otherwise
// and joins them so. @returns whether there was one.
bool Uncross(std::vector<cv::Point2d>& way) {
  const std::size_t n = way.size();
  for (std::size_t i = 0; i + 1 < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      const cv::Point2d &a = way[i], &b = way[i + 1], &c = way[j], &d = way[(j + 1) % n];
      if (cv::norm(a - c) + cv::norm(b - d) < cv::norm(a - b) + cv::norm(c - d) - kEqual_px) {
        std::reverse(way.begin() + static_cast<std::ptrdiff_t>(i) + 1,
                     way.begin() + static_cast<std::ptrdiff_t>(j) + 1);
        return true;
      }
    }
  }
  return false;
}

}  // namespace

std::vector<cv::Point2d> MouthOutline(std::vector<cv::Point2d> points) {
  RequirePixels(points, 0, "points");
  SortByXThenY(points);
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<cv::Point2d> way = Hull(points);
  Insert(points, way);
  while (Uncross(way)) {
  }
  return way;
}

bool GoesRound(const std::vector<cv::Point2d>& outline) {
  RequirePixels(outline, 0, "outline");
  const std::size_t n = outline.size();
  if (n < 4) return true;
  std::vector<double> sides;
  double turned_rad = 0;  // to and fro; once round has 2 pi
  for (std::size_t i = 0; i < n; ++i) {
    const cv::Point2d side = outline[(i + 1) % n] - outline[i];
    const cv::Point2d next = outline[(i + 2) % n] - outline[(i + 1) % n];
    sides.push_back(cv::norm(side));
    turned_rad += std::abs(std::atan2(side.cross(next), side.dot(next)));
  }
  const double turns = std::max(1.0, turned_rad / (2 * std::numbers::pi));
  const double longest = *std::ranges::max_element(sides);
  std::ranges::nth_element(sides, sides.begin() + std::ssize(sides) / 2);
  return longest <= std::min(kLipGap, kWindingGap / turns) * sides[n / 2];
}

MouthDepth DepthWithin(const std::vector<cv::Point2d>& outline, const cv::Rect& box) {
  if (outline.size() < 3) return {};
  RequirePixels(outline, 0, "outline");
  std::vector<cv::Point> corners;
  for (const cv::Point2d& p : outline) corners.emplace_back(cvRound(p.x), cvRound(p.y));
  // The outline's own box is enough: what surrounds it is nearest to what is inside.
  MouthDepth depth{cv::boundingRect(corners) & box, {}};
  if (depth.part.empty()) return {};
  cv::Mat framed, framed_depth;
  cv::copyMakeBorder(FilledContour(corners, depth.part), framed, 1, 1, 1, 1, cv::BORDER_CONSTANT,
                     0);
  cv::distanceTransform(framed, framed_depth, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  depth.px = framed_depth(cv::Rect({1, 1}, depth.part.size()));
  return depth;
}

double ShareOutside(const MouthDepth& depth, const cv::Mat& mask, cv::Point origin) {
  RequireMask(mask, "mask");
  if (depth.part.empty()) return 0;
  const cv::Mat enclosed = depth.px > 0;
  const int all = cv::countNonZero(enclosed);
  if (all == 0) return 0;
  const cv::Rect shown = depth.part & cv::Rect(origin, mask.size());
  const int in_mask =
      shown.empty() ? 0
                    : cv::countNonZero(enclosed(shown - depth.part.tl()) & mask(shown - origin));
  return 1 - static_cast<double>(in_mask) / all;
}

cv::Mat RoomWithin(const MouthDepth& depth, double radius_px) {
  if (depth.part.empty()) return cv::Mat::zeros(depth.part.size(), CV_8UC1);
  double most = 0;
  cv::minMaxLoc(depth.px, nullptr, &most);
  return depth.px >= std::min(radius_px, most);
}

std::optional<MouthWidth> MeasureWidth(const std::vector<cv::Point2d>& outline,
                                       const MouthDepth& depth) {
  if (depth.part.empty()) return std::nullopt;
  const auto inside = [&](cv::Point2d p) {
    const cv::Point pixel(cvRound(p.x), cvRound(p.y));
    return cv::Rect({0, 0}, depth.part.size()).contains(pixel) && depth.px.at<float>(pixel) > 0;
  };
  MouthWidth width;
  cv::Point deepest;
  cv::minMaxLoc(depth.px, nullptr, &width.radius_px, nullptr, &deepest);
  if (width.radius_px <= 0) return std::nullopt;

  const cv::Moments m = cv::moments(depth.px > 0, /*binaryImage=*/true);
  const cv::Point2d along = LongerAxis(m.mu20, m.mu11, m.mu02);
  const auto [first, last] = std::ranges::minmax(outline, {}, [&](auto p) { return along.dot(p); });
  width.length_px = along.dot(last - first);
  cv::Point2d middle(m.m10 / m.m00, m.m01 / m.m00);
  if (!inside(middle)) middle = deepest;  // of a mouth that is bent
  for (const int side : {0, 1}) {
    const cv::Point2d step = (side == 0 ? 1 : -1) * cv::Point2d(-along.y, along.x);
    cv::Point2d p = middle;
    while (inside(p)) p += step;
    width.sides[side] = p + cv::Point2d(depth.part.tl());
  }
  return width;
}

}  // namespace gusset
