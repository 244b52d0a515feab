#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "perception/color_masks.h"
#include "perception/observation.h"
#include "perception/view.h"

namespace gusset {

/// The red body in a frame.
struct CubeBlob {
  std::vector<cv::Point> contour;  ///< px of the frame.
  double area_px2 = 0;
  bool amid_cloth = false;  ///< More than half of what surrounds it is cloth or label.
  bool covered = false;     ///< Cloth touches it, and less shows than a cube's top.
};

/// Width of the cube in pixels where it stands on the table.
double CubeWidth(const View& view, const PerceptionConfig& config);

/// Finds the cube: the largest compact red body anywhere in the frame (at most 2.5 times as long as
/// wide, at least 0.6 of its rectangle filled), or what cloth leaves of one: no longer than its
/// diagonal.
std::optional<CubeBlob> FindCube(const ColorMasks& masks, const View& view,
                                 const PerceptionConfig& config);

/// Where the cube is. With depth, the top face alone is measured, so that the side faces that an
/// overhead camera sees off its axis do not pull centre and yaw; without, the cube is taken to
/// stand on the table and all red pixels to surround its centre. Of a covered cube the centre is
/// that of the square, a cube's width wide, that holds the most of what shows of it and the least
/// of what is neither cube nor cloth; where many do equally well, their mean.
CubeSeen LocateCube(const CubeBlob& blob, const ColorMasks& masks, const View& view,
                    const PerceptionConfig& config);

}  // namespace gusset
