#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "base/random.h"

namespace gusset {

/// A fold that cloth remembers, as its shading shows it: bright on the side that faces the light,
/// dark on the other, a dark line between. Lengths in metres, on the cloth.
struct Crease {
  Eigen::Vector2f middle = {0, 0};
  float angle_rad = 0;    ///< Of its line, from the map's x towards its y.
  float length_m = 0.1f;  ///< It fades out towards either end.
  float bend_1_m = 0;     ///< Curvature of its line.
  float width_m = 0.003f;
  float strength = 0.1f;  ///< Darkest minus even shading; negative: light from the other side.
};

/// Adds a crease to a shading map (CV_32FC1, `px_per_m`, pixel (0, 0)'s centre at the origin).
void AddCrease(cv::Mat& map, const Eigen::Vector2f& px_per_m, const Crease& crease);

/// A crease at a random place of [0, extent], with length, width and strength within `least` and
/// `most`, its angle within spread_rad of `angle_rad`; either side may be the bright one.
Crease RandomCrease(const Eigen::Vector2f& extent_m, float angle_rad, float spread_rad,
                    const Crease& least, const Crease& most, Rng& rng);

}  // namespace gusset
