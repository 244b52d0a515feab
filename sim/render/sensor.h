#pragma once

#include "base/random.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// What the camera adds to an ideal frame. Zero everywhere (gain 1): nothing.
struct SensorConfig {
  double depth_sigma_mm = 1.5;    ///< Standard deviation of depth, all parts together.
  double depth_correlated = 0.7;  ///< Share of that variance that is smooth over about 8 px.
  double color_sigma = 1.5;       ///< Standard deviation of each colour channel, levels of 255.
  double blur_px = 0.55;          ///< Standard deviation of the lens's blur of colour.
  double gain = 1;                ///< Exposure: scales every colour.

  template <class V>
  void Fields(V& v) {
    v("depth_sigma_mm", depth_sigma_mm, {0, 20});
    v("depth_correlated", depth_correlated, {0, 1});
    v("color_sigma", color_sigma, {0, 20});
    v("blur_px", blur_px, {0, 3});
    v("gain", gain, {0.2, 2});
  }
};

/// Makes an ideal frame look like a RealSense D435's. Pixels without depth stay without; others
/// stay at 1 mm or more. Takes two draws from rng, whatever the frame.
/// @throws InputError for frames wider than 5461 px.
void AddSensorNoise(RgbdFrame& frame, const SensorConfig& config, Rng& rng);

}  // namespace gusset
