#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "perception/outline.h"

namespace gusset {

/// The direction in which the mouth looks, from the labels that lie at the edge of the cloth: each
/// is beside the middle of the cloth around it, on the side where the cloth ends. Labels amid
/// cloth, those of a layer that was drawn back onto the body, count for nothing.
/// @param bag CV_8UC1 mask. @param origin of the mask, px; labels are counted from there.
/// @param labels at least one.
/// @param reach_px radius of the cloth around a label.
/// @returns a unit vector of the image.
cv::Point2d RimDirection(const cv::Mat& bag, const std::vector<cv::Point2d>& labels,
                         cv::Point origin, double reach_px);

/// The corners of a body whose rim is where a row of labels lies, though what is left of folds may
/// hide the ends of the rim and make the outline's own sides run elsewhere: from corners[0] to
/// corners[1] along the row, half a spacing beyond the labels at its ends; the other two corners
/// are those of the outline across from it.
/// @param row at least two points (else InputError). @param inset_px a label's middle lies so far
/// inside the rim.
std::array<cv::Point2d, 4> CornersFromRow(const Outline& outline,
                                          const std::vector<cv::Point2d>& row, cv::Point2d outward,
                                          double inset_px);

}  // namespace gusset
