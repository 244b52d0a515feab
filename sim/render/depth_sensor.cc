#include "sim/render/depth_sensor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "sim/render/normal_pool.h"

namespace gusset {
namespace {

/// Noise of variance about 1 that varies over some 8 px: a coarse random grid, made smooth.
cv::Mat_<float> SmoothNoise(cv::Size size, Rng& rng) {
  constexpr int kCell = 8;
  cv::Mat_<float> coarse(size.height / kCell + 2, size.width / kCell + 2);
  for (int row = 0; row < coarse.rows; ++row) {
    std::copy_n(NormalRow(rng), coarse.cols, coarse.ptr<float>(row));
  }
  cv::Mat_<float> fine;
  cv::resize(coarse, fine, {}, kCell, kCell, cv::INTER_LINEAR);
  return fine(cv::Rect(kCell / 2, kCell / 2, size.width, size.height));
}

}  // namespace

void RemoveShadows(cv::Mat& depth_mm, double fx_px, double b_m) {
  const auto shift_px_mm = static_cast<float>(fx_px * b_m * 1000);
  std::vector<float> seen_at(static_cast<std::size_t>(depth_mm.cols));
  for (int row = 0; row < depth_mm.rows; ++row) {
    // Pixels a column apart change places only if their shifts differ by more than that.
    double nearest = 0, farthest = 0;
    cv::minMaxLoc(depth_mm.row(row), &nearest, &farthest);
    if (nearest > 0 && shift_px_mm * (1 / nearest - 1 / farthest) < 1) continue;
    auto* depth = depth_mm.ptr<std::uint16_t>(row);
    for (int u = 0; u < depth_mm.cols; ++u) {
      const auto z = static_cast<float>(depth[u]);
      const float shift = shift_px_mm / std::max(z, 1.0f);
      seen_at[u] = static_cast<float>(u) - (z > 0 ? shift : 0.0f);
    }
    float leftmost = std::numeric_limits<float>::infinity();
    for (int u = depth_mm.cols - 1; u >= 0; --u) {
      depth[u] = seen_at[u] > leftmost ? 0 : depth[u];
      leftmost = std::min(leftmost, seen_at[u]);
    }
  }
}

void RemoveEdges(cv::Mat& depth_mm, double step_mm) {
  if (step_mm <= 0) return;
  cv::Mat nearest, farthest, edge;
  cv::erode(depth_mm, nearest, cv::noArray());
  cv::dilate(depth_mm, farthest, cv::noArray());
  cv::subtract(farthest, nearest, farthest);
  cv::compare(farthest, step_mm, edge, cv::CMP_GT);
  depth_mm.setTo(0, edge);
}

void AddDisparityNoise(cv::Mat& depth_mm, const SensorConfig& config, Rng& rng) {
  if (config.depth_sigma_mm <= 0 && config.disparity_step_px <= 0) return;
  const double focal_baseline = config.depth_focal_px * config.baseline_m * 1000;  // px mm
  const double sigma_px = config.depth_sigma_mm * focal_baseline / (1000.0 * 1000.0);
  // Bilinear interpolation between independent values keeps (2/3)^2 of the variance on average.
  const auto smooth_scale = static_cast<float>(1.5 * sigma_px * std::sqrt(config.depth_correlated));
  const auto white_scale = static_cast<float>(sigma_px * std::sqrt(1 - config.depth_correlated));
  const auto scale = static_cast<float>(focal_baseline);
  const auto farthest = static_cast<float>(focal_baseline / 65535);
  const auto step = static_cast<float>(config.disparity_step_px);
  const float per_step = step > 0 ? 1 / step : 0;
  const cv::Mat_<float> smooth = SmoothNoise(depth_mm.size(), rng);
  // In several loops, which the compiler makes vectors of; in one it does not.
  std::vector<float> ideal(static_cast<std::size_t>(depth_mm.cols)), disparity(ideal.size());
  for (int row = 0; row < depth_mm.rows; ++row) {
    auto* depth = depth_mm.ptr<std::uint16_t>(row);
    const float* slow = smooth.ptr<float>(row);
    const float* white = NormalRow(rng);
    for (int u = 0; u < depth_mm.cols; ++u) {
      ideal[u] = static_cast<float>(depth[u]);
      const float d = scale / std::max(ideal[u], 1.0f);
      disparity[u] = std::max(d + (smooth_scale * slow[u] + white_scale * white[u]), farthest);
    }
    if (config.disparity_step_px > 0) {
      for (float& d : disparity) {
        // Steps that an int cannot count are too fine to matter.
        const float steps = std::min(d * per_step + 0.5f, 2e9f);
        d = std::max(static_cast<float>(static_cast<int>(steps)) * step, farthest);
      }
    }
    for (int u = 0; u < depth_mm.cols; ++u) {
      const float noisy = std::min(std::max(scale / disparity[u] + 0.5f, 1.0f), 65535.0f);
      disparity[u] = ideal[u] > 0 ? noisy : 0.0f;
    }
    for (int u = 0; u < depth_mm.cols; ++u) {
      depth[u] = static_cast<std::uint16_t>(static_cast<int>(disparity[u]));
    }
  }
}

}  // namespace gusset
