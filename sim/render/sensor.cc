#include "sim/render/sensor.h"

#include <algorithm>
#include <array>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/error.h"
#include "sim/render/depth_sensor.h"
#include "sim/render/normal_pool.h"

namespace gusset {
namespace {

void AddColorNoise(cv::Mat& color, const SensorConfig& config, Rng& rng) {
  const auto sigma = static_cast<float>(config.color_sigma);
  const std::array<float, 3> bgr = {static_cast<float>(config.gain * config.blue_gain),
                                    static_cast<float>(config.gain),
                                    static_cast<float>(config.gain * config.red_gain)};
  const int row_length = 3 * color.cols;
  std::vector<float> gains(static_cast<std::size_t>(row_length));
  for (int i = 0; i < row_length; ++i) gains[i] = bgr[static_cast<std::size_t>(i % 3)];
  for (int row = 0; row < color.rows; ++row) {
    uchar* value = color.ptr<uchar>(row);
    const float* normal = NormalRow(rng);
    for (int i = 0; i < row_length; ++i) {
      const float noisy = static_cast<float>(value[i]) * gains[i] + sigma * normal[i] + 0.5f;
      value[i] = static_cast<uchar>(static_cast<int>(std::min(std::max(noisy, 0.0f), 255.0f)));
    }
  }
}

}  // namespace

void AddSensorNoise(RgbdFrame& frame, const SensorConfig& config, double fx_px, Rng& rng) {
  if (3 * frame.color.cols > kMaxNormalRow) throw InputError("frame too wide for the sensor model");
  // Streams of their own, so that neither part's setting moves the other's noise.
  Rng color_rng(rng.Bits());
  Rng depth_rng(rng.Bits());
  if (config.preset == "clean") return;
  if (config.blur_px > 0) {
    cv::GaussianBlur(frame.color, frame.color, {5, 5}, config.blur_px, config.blur_px);
  }
  AddColorNoise(frame.color, config, color_rng);
  if (frame.depth_mm.empty()) return;
  // Both look at the ideal surface.
  cv::Mat seen = frame.depth_mm.clone();
  if (config.shadows) RemoveShadows(seen, fx_px, config.imager_offset_m + config.baseline_m);
  RemoveEdges(frame.depth_mm, config.edge_step_mm);
  cv::min(seen, frame.depth_mm, frame.depth_mm);
  AddDisparityNoise(frame.depth_mm, config, depth_rng);
}

}  // namespace gusset
