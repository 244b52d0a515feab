#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

namespace gusset {

/// A four-sided figure: the first side runs from corner 0 to corner 1 (the rim, where there is
/// one).
using Quad = std::array<cv::Point2d, 4>;

/// The point at the share `along` of the way from corner 0's end to corner 1's, and `away` of the
/// way from the first side to the opposite one; both 0..1.
cv::Point2d GridPoint(const Quad& quad, double along, double away);

/// Centres of the cells of a zeta x zeta grid (Eq. 5.12), row by row from the first side.
std::vector<cv::Point2d> CellCentres(const Quad& quad, int zeta);

/// `count` points on a line beside the first side, at 0.5/9 of the figure's length from it. Tuned,
/// 2026-11, on unfolded starts of Bag 1: a page turns only when it is held near its rim. (The
/// thesis's authors used 1.6/9 in their own code.)
std::vector<cv::Point2d> RimPoints(const Quad& quad, int count);

/// Where the body ends on each point's side of its centre: the farthest pixel of its contour within
/// `cone_rad` of the direction from the centre to the point, less `inset_px`. A point closer to the
/// centre than `central_px` has no side and stays, as does one with no contour on its side.
/// @param contour its pixel (0, 0) is at `origin`. @throws InputError if it holds what is no pixel.
std::vector<cv::Point2d> EdgePoints(const std::vector<cv::Point>& contour, cv::Point origin,
                                    cv::Point2d centre, const std::vector<cv::Point2d>& points,
                                    double cone_rad, double inset_px, double central_px);

/// Moves each point to the nearest pixel of the mask that is at least `inset_px`
/// from its edge (of the mask itself, where it is too thin for that). An empty mask moves nothing.
/// @param mask CV_8UC1; its pixel (0, 0) is at `origin`.
void SnapOnto(const cv::Mat& mask, cv::Point origin, double inset_px,
              std::vector<cv::Point2d>& points);

}  // namespace gusset
