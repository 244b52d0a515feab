#include "sim/render/creases.h"

#include <algorithm>
#include <cmath>

namespace gusset {

void AddCrease(cv::Mat& map, const Eigen::Vector2f& px_per_m, const Crease& crease) {
  const Eigen::Vector2f along(std::cos(crease.angle_rad), std::sin(crease.angle_rad));
  const Eigen::Vector2f across(-along.y(), along.x());
  const float half = crease.length_m / 2;
  const float sag = std::abs(crease.bend_1_m) * half * half / 2;
  const float reach = 3 * crease.width_m + sag;
  const Eigen::Vector2f box =
      (along.cwiseAbs() * half + across.cwiseAbs() * reach).cwiseProduct(px_per_m);
  const Eigen::Vector2f centre = crease.middle.cwiseProduct(px_per_m);
  const int row0 = std::max(0, static_cast<int>(centre.y() - box.y()));
  const int row1 = std::min(map.rows - 1, static_cast<int>(centre.y() + box.y()));
  const int col0 = std::max(0, static_cast<int>(centre.x() - box.x()));
  const int col1 = std::min(map.cols - 1, static_cast<int>(centre.x() + box.x()));
  for (int row = row0; row <= row1; ++row) {
    for (int col = col0; col <= col1; ++col) {
      const Eigen::Vector2f from_middle =
          Eigen::Vector2f(static_cast<float>(col), static_cast<float>(row))
              .cwiseQuotient(px_per_m) -
          crease.middle;
      const float s = from_middle.dot(along);
      const float t = (from_middle.dot(across) - 0.5f * crease.bend_1_m * s * s) / crease.width_m;
      if (std::abs(s) > half || std::abs(t) > 3) continue;
      const float inside = 1 - s * s / (half * half);
      const float fade = inside * inside;
      // Slope of a bell-shaped ridge, 1 at its steepest, and the line where the threads are bent.
      const float slope = 1.6487f * t * std::exp(-0.5f * t * t);
      const float line = std::exp(-4 * t * t);
      map.at<float>(row, col) +=
          fade * (crease.strength * slope - 0.3f * std::abs(crease.strength) * line);
    }
  }
}

Crease RandomCrease(const Eigen::Vector2f& extent_m, float angle_rad, float spread_rad,
                    const Crease& least, const Crease& most, Rng& rng) {
  const auto between = [&](float lo, float hi) {
    return lo + (hi - lo) * static_cast<float>(rng.Uniform());
  };
  Crease crease;
  crease.middle.x() = between(0, extent_m.x());
  crease.middle.y() = between(0, extent_m.y());
  crease.angle_rad = angle_rad + between(-spread_rad, spread_rad);
  crease.length_m = between(least.length_m, most.length_m);
  crease.bend_1_m = between(least.bend_1_m, most.bend_1_m);
  crease.width_m = between(least.width_m, most.width_m);
  crease.strength = between(least.strength, most.strength);
  if (rng.Uniform() < 0.5) crease.strength = -crease.strength;
  return crease;
}

}  // namespace gusset
