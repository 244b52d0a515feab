#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "perception/config.h"

namespace gusset {

/// Where cloth ends in a hem: a piece of one of the mouth's lips.
struct HemPoint {
  cv::Point2d line_px;  ///< On the hem's stitching.
  cv::Point2d outward;  ///< Unit vector, from the stitching to the free edge.
  double edge_px = 0;   ///< How far away that edge is.
};

/// Finds the lips of the mouth without labels: the stitching of a hem is a thin dark line, and, at
/// the hem's width from it, the cloth ends: where the bag does, or where depth falls by more than
/// one layer of cloth. Neither alone tells: ironed folds are dark lines, too, and edges of folds
/// are steps, too.
///
/// One pixel's depth says nothing about a layer 1.5 mm thick: noise is as large. Brightness and
/// depth are therefore both averaged over 15 pixels along the line, step by step across it.
/// Lines are the ridges of Steger 1998 ("An unbiased detector of curvilinear structures", PAMI
/// 20(2)). That kinds of edges tell how cloth is folded: Gabas and Kita 2021 ("Dual edge classifier
/// for robust cloth unfolding", ROBOMECH Journal 8), who learn them from pictures.
///
/// @param color CV_8UC3. @param depth_mm CV_16UC1 of the same size, 0: no return; or empty, and
///   only lips on the bag's own edge are found. @param bag CV_8UC1, of the same size; the bag.
/// @returns row by row, from left to right. @throws InputError if an image is not as described.
std::vector<HemPoint> FindHem(const cv::Mat& color, const cv::Mat& depth_mm, const cv::Mat& bag,
                              const PerceptionConfig& config);

/// The lips as labels would show them, so that whatever is measured on labels can be measured on a
/// bag that has none: points label_inset_px inside the edge, hem_spacing_px apart along each piece
/// of hem; the mean of each group. At most `most`: those that most of the hem speaks for. Pixels
/// are the images'.
std::vector<cv::Point2d> FindLipPoints(const cv::Mat& color, const cv::Mat& depth_mm,
                                       const cv::Mat& bag, int most,
                                       const PerceptionConfig& config);

}  // namespace gusset
