#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "perception/config.h"
#include "perception/observation.h"
#include "perception/view.h"

namespace gusset {

/// Median, in mm, of the depths that are measurements: not 0 and within the config's bounds. Of two
/// middle values the nearer: a depth that was measured, never one between two surfaces.
/// @returns std::nullopt if there is none.
std::optional<double> MedianDepth(std::vector<std::uint16_t> depths_mm,
                                  const PerceptionConfig& config);

/// Distance (m, along the optical axis) of the surface at a pixel: the median over a small window,
/// cut at the image's edge.
std::optional<double> DepthAt(const View& view, cv::Point2d px, const PerceptionConfig& config);

/// Where the pixel's surface lies in the world; on the table, and marked so, without a depth.
PosePoint Deproject(const View& view, cv::Point2d px, const PerceptionConfig& config);

/// Where the pixel's ray meets a level plane; the world's origin at that height if it never does.
Eigen::Vector3d OntoLevel(const View& view, cv::Point2d px, double height_m);

}  // namespace gusset
