#include "perception/shapes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "perception/require.h"

namespace gusset {

cv::Mat FilledContour(const std::vector<cv::Point>& contour, const cv::Rect& box) {
  RequirePixels(contour, 1, "contour");
  cv::Mat mask = cv::Mat::zeros(box.size(), CV_8UC1);
  cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{contour}, 255, cv::LINE_8, 0, -box.tl());
  return mask;
}

void SortByXThenY(std::vector<cv::Point2d>& points) {
  std::sort(points.begin(), points.end(),
            [](cv::Point2d a, cv::Point2d b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
}

cv::Point2d LongerAxis(double xx, double xy, double yy) {
  const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
  return {std::cos(angle), std::sin(angle)};
}

FittedLine FitLine(const std::vector<cv::Point2d>& points) {
  FittedLine line;
  const double count = static_cast<double>(points.size());
  for (const cv::Point2d& point : points) line.mean += point / count;
  double xx = 0, xy = 0, yy = 0;
  for (const cv::Point2d& point : points) {
    const cv::Point2d d = point - line.mean;
    xx += d.x * d.x;
    xy += d.x * d.y;
    yy += d.y * d.y;
  }
  line.along = LongerAxis(xx, xy, yy);
  for (const cv::Point2d& point : points) {
    line.least = std::min(line.least, line.along.dot(point - line.mean));
    line.most = std::max(line.most, line.along.dot(point - line.mean));
  }
  return line;
}

}  // namespace gusset
