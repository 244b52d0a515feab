#include "perception/outline.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "perception/pose_points.h"
#include "perception/require.h"

namespace gusset {
namespace {

template <class Point>
cv::Point2d Centroid(const std::vector<Point>& contour) {
  const cv::Moments moments = cv::moments(contour);
  if (moments.m00 > 0) return {moments.m10 / moments.m00, moments.m01 / moments.m00};
  cv::Point2d sum(0, 0);
  for (const Point& point : contour) sum += cv::Point2d(point);
  return sum / static_cast<double>(contour.size());
}

cv::Point2d RectCorner(const Outline& outline, int k) {
  const int before = (k + 3) % 4;
  return outline.middle + outline.normals[k] * outline.reach[k] +
         outline.normals[before] * outline.reach[before];
}

// The largest quadrilateral whose corners are points of the contour: for each diagonal the farthest
// point on either side. Against the clock as one sees the image. None for fewer than four points in
// convex position.
template <class Point>
std::optional<Quad> LargestQuad(const std::vector<Point>& contour) {
  std::vector<Point> hull;
  cv::convexHull(contour, hull, /*clockwise=*/false);
  const std::size_t n = hull.size();
  if (n < 4) return std::nullopt;
  double largest = 0;
  Quad quad;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = i + 2; j < n; ++j) {
      const cv::Point2d from(hull[i]);
      const cv::Point2d diagonal = cv::Point2d(hull[j]) - from;
      std::array<double, 2> height{};
      std::array<cv::Point2d, 2> farthest{};
      for (std::size_t k = 0; k < n; ++k) {
        const int side = k > i && k < j ? 0 : 1;
        const double h = std::abs(diagonal.cross(cv::Point2d(hull[k]) - from));
        if (h <= height[side]) continue;
        height[side] = h;
        farthest[side] = cv::Point2d(hull[k]);
      }
      if (height[0] <= 0 || height[1] <= 0 || height[0] + height[1] <= largest) continue;
      largest = height[0] + height[1];
      quad = {from, farthest[0], cv::Point2d(hull[j]), farthest[1]};
    }
  }
  if (largest <= 0) return std::nullopt;
  // The image's y points down, so one sees a positive turn as clockwise.
  if ((quad[1] - quad[0]).cross(quad[2] - quad[0]) > 0) std::swap(quad[1], quad[3]);
  return quad;
}

// The quad counted from the corner from which it lies best along the four directions.
Quad Matched(const Quad& quad, const std::array<cv::Point2d, 4>& directions) {
  const auto score = [&](int first) {
    double sum = 0;
    for (int k = 0; k < 4; ++k) sum += quad[(first + k) % 4].dot(directions[k]);
    return sum;
  };
  int best = 0;
  for (int first = 1; first < 4; ++first) {
    if (score(first) > score(best)) best = first;
  }
  Quad matched = quad;
  std::rotate(matched.begin(), matched.begin() + best, matched.end());
  return matched;
}

template <class Point>
Outline Fit(const std::vector<Point>& contour) {
  RequirePixels(contour, 1, "contour");
  Outline outline;
  outline.centroid = Centroid(contour);
  const cv::RotatedRect rect = cv::minAreaRect(contour);
  const double angle = rect.angle * CV_PI / 180;
  const cv::Point2d right(std::cos(angle), std::sin(angle));
  const cv::Point2d down(-right.y, right.x);
  outline.middle = cv::Point2d(rect.center);
  outline.normals = {-down, -right, down, right};
  outline.reach = {rect.size.height / 2., rect.size.width / 2., rect.size.height / 2.,
                   rect.size.width / 2.};

  std::array<cv::Point2d, 4> diagonals;
  for (int k = 0; k < 4; ++k) diagonals[k] = outline.normals[k] + outline.normals[(k + 3) % 4];
  if (const std::optional<Quad> quad = LargestQuad(contour)) {
    outline.corners = Matched(*quad, diagonals);
    return outline;
  }
  for (int k = 0; k < 4; ++k) {
    outline.corners[k] = *std::max_element(contour.begin(), contour.end(), [&](Point a, Point b) {
      return cv::Point2d(a).dot(diagonals[k]) < cv::Point2d(b).dot(diagonals[k]);
    });
  }
  return outline;
}

}  // namespace

Outline Outline::From(int first) const {
  Outline turned = *this;
  std::rotate(turned.corners.begin(), turned.corners.begin() + first, turned.corners.end());
  std::rotate(turned.normals.begin(), turned.normals.begin() + first, turned.normals.end());
  std::rotate(turned.reach.begin(), turned.reach.begin() + first, turned.reach.end());
  return turned;
}

Outline FitOutline(const std::vector<cv::Point>& contour) { return Fit(contour); }
Outline FitOutline(const std::vector<cv::Point2f>& contour) { return Fit(contour); }

int SideTowards(const Outline& outline, cv::Point2d direction) {
  int best = 0;
  for (int side = 1; side < 4; ++side) {
    if (outline.normals[side].dot(direction) > outline.normals[best].dot(direction)) best = side;
  }
  return best;
}

int UpperRightCorner(const Outline& outline) {
  const cv::Point2d upper_right(1, -1);
  int best = 0;
  for (int k = 1; k < 4; ++k) {
    if (RectCorner(outline, k).dot(upper_right) > RectCorner(outline, best).dot(upper_right)) {
      best = k;
    }
  }
  return best;
}

}  // namespace gusset
