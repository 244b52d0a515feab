#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace gusset {

using Triangle = std::array<cv::Point2d, 3>;

/// The mouth as Algorithm 7 sees it.
struct Opening {
  double area_px2 = 0;  ///< Area of the union of the triangles.
  cv::Point2d centre;   ///< Centroid of that union; mean of the points if the area is 0.
  std::vector<Triangle> triangles;  ///< First vertex: the mean of the points.
};

/// Algorithm 7 of the thesis over the labels' centroids: from the point nearest to the centre, a
/// triangle with the centre and its nearest other point, one with its second nearest; that point is
/// then taken away, until fewer than three are left. Two corrections: a point is not its own
/// nearest neighbour, and triangles that overlap count once.
///
/// The result is bit-identical for any order of the points: they are sorted first, and equal
/// distances are decided by that order (by x, then y). For this reason a shape with exact ties,
/// such as a square, may give another area once turned; without ties the area is the same for any
/// rotation, shift or reflection. Fewer than three points: no triangles, area 0. O(n^3 log n).
Opening MeasureOpening(std::vector<cv::Point2d> points);

}  // namespace gusset
