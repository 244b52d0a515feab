#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace gusset {

/// Mask of the pixels that a contour encloses, itself included: CV_8UC1, 0 or 255, as large as
/// `box`. The contour counts in the pixels that the box lies in. @throws InputError if it is empty
/// or holds what is no pixel.
cv::Mat FilledContour(const std::vector<cv::Point>& contour, const cv::Rect& box);

/// For results that do not depend on the order of points.
void SortByXThenY(std::vector<cv::Point2d>& points);

/// Unit vector along the longer principal axis of second moments about the centroid; either sense.
cv::Point2d LongerAxis(double xx, double xy, double yy);

/// The line along which points vary most: the longer principal axis of their covariance.
struct FittedLine {
  cv::Point2d mean;
  cv::Point2d along;           ///< Unit vector; either sense.
  double least = 0, most = 0;  ///< How far the points reach from the mean, along it.
};

/// @param points at least one.
FittedLine FitLine(const std::vector<cv::Point2d>& points);

}  // namespace gusset
