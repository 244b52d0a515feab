#include "perception/outline.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

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

template <class Point>
Outline Fit(const std::vector<Point>& contour) {
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

  std::array<double, 4> farthest{};
  // A quadrant without a point (the mouth may have as few as three) takes the point that lies
  // farthest towards it.
  for (int k = 0; k < 4; ++k) {
    const cv::Point2d diagonal = outline.normals[k] + outline.normals[(k + 3) % 4];
    outline.corners[k] = *std::max_element(contour.begin(), contour.end(), [&](Point a, Point b) {
      return cv::Point2d(a).dot(diagonal) < cv::Point2d(b).dot(diagonal);
    });
  }
  for (const Point& point : contour) {
    const cv::Point2d offset = cv::Point2d(point) - outline.centroid;
    const bool is_right = offset.dot(right) >= 0;
    const bool is_down = offset.dot(down) >= 0;
    // Corner 0 lies between sides right (3) and up (0), and so on against the clock.
    const int k = is_down ? (is_right ? 3 : 2) : (is_right ? 0 : 1);
    if (offset.dot(offset) <= farthest[k]) continue;
    farthest[k] = offset.dot(offset);
    outline.corners[k] = cv::Point2d(point);
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

int SideNearest(const Outline& outline, const std::vector<cv::Point2d>& points) {
  std::array<double, 4> score{};
  for (int side = 0; side < 4; ++side) {
    for (const cv::Point2d& point : points) {
      // 0 at the middle or beyond, 1 at the side; squared, so that those at the side decide.
      const double near = std::max(0., (point - outline.middle).dot(outline.normals[side]) /
                                           std::max(outline.reach[side], 1.));
      score[side] += near * near;
    }
  }
  return static_cast<int>(std::max_element(score.begin(), score.end()) - score.begin());
}

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
