#include "sim/render/sensor.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "base/error.h"

namespace gusset {
namespace {

constexpr int kPoolSize = 1 << 18;
constexpr int kMaxRow = 1 << 14;  // longest row, in numbers, that is drawn from the pool at once

/// Standard normal numbers to draw rows of pixels from, each row from a random place: a million
/// fresh ones per frame would take longer than the frame itself. Ends with a copy of its beginning.
const std::vector<float>& NormalPool() {
  static const std::vector<float> pool = [] {
    Rng rng(DeriveSeed(1, "normal pool"));
    std::vector<float> values(kPoolSize);
    // In pairs of opposite sign: the mean is 0 exactly.
    for (std::size_t i = 0; i < values.size(); i += 2) {
      values[i] = static_cast<float>(rng.Normal());
      values[i + 1] = -values[i];
    }
    // Neighbours in a row must not be each other's mirror image.
    for (int i = kPoolSize - 1; i > 0; --i) std::swap(values[i], values[rng.Below(i + 1)]);
    for (int i = 0; i < kMaxRow; ++i) values.push_back(values[i]);
    return values;
  }();
  return pool;
}

/// n <= kMaxRow standard normal numbers.
const float* NormalRow(Rng& rng) { return NormalPool().data() + rng.Below(kPoolSize); }

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

void AddDepthNoise(cv::Mat& depth_mm, const SensorConfig& config, Rng& rng) {
  // Bilinear interpolation between independent values keeps (2/3)^2 of the variance on average.
  const auto smooth_scale =
      static_cast<float>(1.5 * config.depth_sigma_mm * std::sqrt(config.depth_correlated));
  const auto white_scale =
      static_cast<float>(config.depth_sigma_mm * std::sqrt(1 - config.depth_correlated));
  const cv::Mat_<float> smooth = SmoothNoise(depth_mm.size(), rng);
  for (int row = 0; row < depth_mm.rows; ++row) {
    auto* depth = depth_mm.ptr<std::uint16_t>(row);
    const float* slow = smooth.ptr<float>(row);
    const float* white = NormalRow(rng);
    for (int i = 0; i < depth_mm.cols; ++i) {
      const float noisy =
          static_cast<float>(depth[i]) + smooth_scale * slow[i] + white_scale * white[i] + 0.5f;
      const int clipped = static_cast<int>(std::min(std::max(noisy, 1.0f), 65535.0f));
      depth[i] = static_cast<std::uint16_t>(depth[i] == 0 ? 0 : clipped);
    }
  }
}

void AddColorNoise(cv::Mat& color, const SensorConfig& config, Rng& rng) {
  const auto sigma = static_cast<float>(config.color_sigma);
  for (int row = 0; row < color.rows; ++row) {
    uchar* value = color.ptr<uchar>(row);
    const float* normal = NormalRow(rng);
    for (int i = 0; i < 3 * color.cols; ++i) {
      const float noisy = static_cast<float>(value[i]) + sigma * normal[i] + 0.5f;
      value[i] = static_cast<uchar>(static_cast<int>(std::min(std::max(noisy, 0.0f), 255.0f)));
    }
  }
}

}  // namespace

void AddSensorNoise(RgbdFrame& frame, const SensorConfig& config, Rng& rng) {
  if (3 * frame.color.cols > kMaxRow) throw InputError("frame too wide for the sensor model");
  // Streams of their own, so that neither part's setting moves the other's noise.
  Rng color_rng(rng.Bits());
  Rng depth_rng(rng.Bits());
  if (config.blur_px > 0) {
    cv::GaussianBlur(frame.color, frame.color, {5, 5}, config.blur_px, config.blur_px);
  }
  if (config.gain != 1) frame.color.convertTo(frame.color, -1, config.gain);
  if (config.color_sigma > 0) AddColorNoise(frame.color, config, color_rng);
  if (config.depth_sigma_mm > 0 && !frame.depth_mm.empty()) {
    AddDepthNoise(frame.depth_mm, config, depth_rng);
  }
}

}  // namespace gusset
