#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace gusset {

/// A body as a four-sided figure, for the grid of Eq. 5.12.
struct Outline {
  cv::Point2d centroid;  ///< Of the area that the contour encloses, px.
  /// Of the largest quadrilateral between points of the contour. Counter-clockwise as one sees the
  /// image (y down). (The thesis takes the farthest point in each quadrant about the centroid,
  /// which leaves much of a crumpled bag outside.)
  std::array<cv::Point2d, 4> corners;
  /// Outward unit normals of the sides of the minimum-area rectangle; side k runs from corner k to
  /// corner k + 1. Corners are numbered as this rectangle's, so that yaw does not matter.
  std::array<cv::Point2d, 4> normals;
  /// Centre of the minimum-area rectangle, and how far its sides are from there.
  cv::Point2d middle;
  std::array<double, 4> reach;

  /// The same figure, counted from corner `first`.
  Outline From(int first) const;
};

/// @param contour a closed polygon with at least one point, as pixels (else InputError); if it
/// encloses no area, the centroid
///   is the mean of its points.
Outline FitOutline(const std::vector<cv::Point>& contour);
Outline FitOutline(const std::vector<cv::Point2f>& contour);

/// The side that looks most nearly in the given direction.
int SideTowards(const Outline& outline, cv::Point2d direction);

/// The corner of the minimum-area rectangle farthest to the image's upper right.
int UpperRightCorner(const Outline& outline);

}  // namespace gusset
