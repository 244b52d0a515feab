#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace gusset {

/// The mouth's lips as one closed curve: points on them, in the order of the shortest closed way
/// through all. Unlike their hull it leaves out the cloth between the arms of a mouth that is bent,
/// as round a folded corner. The hull with every other point put in where it lengthens the way
/// least, then 2-opt (Croes 1958) until no two sides cross; of the labels of 1,422 rendered frames
/// this was the shortest way every time.
///
/// The result is the same for any order of the points. Fewer than three: as they are.
std::vector<cv::Point2d> MouthOutline(std::vector<cv::Point2d> points);

/// Whether labels go round the mouth: no side of its outline is more than kLipGap times as long as
/// the median one (of an even number the upper), or, if the outline winds, than kWindingGap / turns
/// times. Else all that show lie on one bent lip, as beside a folded corner, and the longest side
/// crosses cloth or table; or they stand in rows one behind the other, and the outline encloses
/// the outside of cloth that lies between two rows. Of fewer than four points: true.
bool GoesRound(const std::vector<cv::Point2d>& outline);

/// Labels are evenly spaced along a lip, so twice the spacing is a gap of one that is hidden, seen
/// aslant perhaps. Tuned 2026-11 on 513 frames of s2 with room for the cube: of 388 below it 6 have
/// place points beside the mouth, of 125 above it 107 (docs/perception.md).
inline constexpr double kLipGap = 2.5;

/// An outline that turns by more than once round, to and fro, goes round one bend (a mouth bent
/// round a folded corner) or between rows of labels: the more it winds, the less of a gap is
/// believed. Tuned 2026-11 on 752 frames of s2 with room: 10 of 15 above it have place points
/// beside the mouth, 15 of 737 below it, and 10 of these show table (kTableShare).
inline constexpr double kWindingGap = 3.3;

/// How far inside a mouth's outline each pixel lies.
struct MouthDepth {
  cv::Rect part;  ///< Where the outline is, of the box that was asked for.
  cv::Mat px;     ///< Of each pixel of `part`, CV_32FC1, 0 outside. Empty if `part` is.
};

/// Distance from what lies outside the outline or `box`, both in the image's pixels. Nothing if the
/// outline has fewer than three points.
MouthDepth DepthWithin(const std::vector<cv::Point2d>& outline, const cv::Rect& box);

/// The share of what the outline encloses where the mask is 0, or ends: table, if the mask is the
/// bag's, for through a mouth one sees cloth alone (or a shadow, which FindBag fills up to
/// hole_max_px2). 0 if the outline encloses nothing.
/// @param mask CV_8UC1; its pixel (0, 0) is at `origin`.
double ShareOutside(const MouthDepth& depth, const cv::Mat& mask, cv::Point origin);

/// Above this share of table the outline is not the mouth's. Tuned 2026-11 on the frames of
/// kWindingGap: at most 4 % of a mouth that holds its place points is table (a straight side cuts
/// across its bent end), of one that does not 32 %.
inline constexpr double kTableShare = 0.1;

/// Where a disc finds room: mask of the pixels at least radius_px inside (or as far inside as any
/// is, if the mouth is narrower): CV_8UC1, 0 or 255, as large as depth.part.
cv::Mat RoomWithin(const MouthDepth& depth, double radius_px);

/// How wide a mouth is, and how long.
struct MouthWidth {
  double radius_px = 0;  ///< Of the largest disc inside the outline.
  double length_px = 0;  ///< Of the outline, along its longer axis.
  /// Where the outline is on either side of its middle, across its longer axis.
  std::array<cv::Point2d, 2> sides;
};

/// @param depth of that outline; what it holds beyond depth's box counts for length_px alone.
/// @returns nothing if the outline holds no pixel.
std::optional<MouthWidth> MeasureWidth(const std::vector<cv::Point2d>& outline,
                                       const MouthDepth& depth);

}  // namespace gusset
