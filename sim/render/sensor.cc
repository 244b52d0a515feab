#include "sim/render/sensor.h"

#include <emmintrin.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/error.h"
#include "sim/render/depth_sensor.h"
#include "sim/render/normal_pool.h"

namespace gusset {
namespace {

/// Exposure and white balance.
void ScaleColors(cv::Mat& color, const SensorConfig& config) {
  const std::array<double, 3> bgr = {config.gain * config.blue_gain, config.gain,
                                     config.gain * config.red_gain};
  if (bgr == std::array<double, 3>{1, 1, 1}) return;
  cv::Mat table(1, 256, CV_8UC3);
  for (int level = 0; level < 256; ++level) {
    for (int k = 0; k < 3; ++k) {
      table.at<cv::Vec3b>(level)[k] =
          static_cast<uchar>(std::min(level * bgr[static_cast<std::size_t>(k)] + 0.5, 255.0));
    }
  }
  cv::LUT(color, table, color);
}

/// Adds n numbers to n levels, cut at 0 and 255.
void AddSaturating(uchar* level, const std::int16_t* add, int n) {
  int i = 0;
  for (; i + 16 <= n; i += 16) {
    const auto* at = reinterpret_cast<const __m128i*>(add + i);
    const __m128i levels = _mm_loadu_si128(reinterpret_cast<const __m128i*>(level + i));
    const __m128i low = _mm_unpacklo_epi8(levels, _mm_setzero_si128());
    const __m128i high = _mm_unpackhi_epi8(levels, _mm_setzero_si128());
    _mm_storeu_si128(reinterpret_cast<__m128i*>(level + i),
                     _mm_packus_epi16(_mm_add_epi16(low, _mm_loadu_si128(at)),
                                      _mm_add_epi16(high, _mm_loadu_si128(at + 1))));
  }
  for (; i < n; ++i) level[i] = static_cast<uchar>(std::clamp(level[i] + add[i], 0, 255));
}

void AddColorNoise(cv::Mat& color, const SensorConfig& config, Rng& rng) {
  if (config.color_sigma <= 0) return;
  // Levels are whole, so noise may be rounded before it is added: once per number of the pool, of
  // which there are fewer than values in a frame, and then in integers.
  const auto sigma = static_cast<float>(config.color_sigma);
  const std::vector<float>& pool = NormalPool();
  std::vector<std::int16_t> noise(pool.size());
  constexpr int kAbove = 1024;  // keeps what is cut to an integer positive
  for (std::size_t i = 0; i < pool.size(); ++i) {
    noise[i] = static_cast<std::int16_t>(
        static_cast<int>(sigma * pool[i] + (static_cast<float>(kAbove) + 0.5f)) - kAbove);
  }
  for (int row = 0; row < color.rows; ++row) {
    AddSaturating(color.ptr<uchar>(row), noise.data() + NormalPlace(rng), 3 * color.cols);
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
  ScaleColors(frame.color, config);
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
