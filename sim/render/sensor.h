#pragma once

#include <string>

#include "base/random.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// What the camera makes of an ideal frame. The defaults are an Intel RealSense D435's; where they
/// come from stands in docs/camera.md, in short:
/// [1] Grunnet-Jepsen, Sweetser, Woodfill: Tuning depth cameras for best performance (Intel).
/// [2] Grunnet-Jepsen et al.: Subpixel linearity improvement for D400 depth cameras (Intel).
/// [3] realsense2_description, _d435.urdf.xacro: offsets of the imagers.
/// [4] Nguyen, Izadi, Lovell 2012: Modeling Kinect sensor noise, 3DIMPVT.
struct SensorConfig {
  /// "realsense": all that follows. "clean": the ideal frame to the bit, whatever follows.
  std::string preset = "realsense";

  /// Standard deviation of depth at 1 m, all parts together; grows with the distance's square [1].
  /// 1.4 mm is 0.044 px of disparity; the thesis, which met fluctuations of 1 mm, names no figure.
  double depth_sigma_mm = 1.4;
  double depth_correlated = 0.7;  ///< Share of that variance that is smooth over about 8 px.
  /// Disparity comes in steps of this [2], so depth in steps of z^2 / (f B) times it; 0: none.
  double disparity_step_px = 1.0 / 32;
  double depth_focal_px = 638;  ///< f of the infrared imagers at 1280x720.
  double baseline_m = 0.050;    ///< B, from the left imager to the right one [1], [3].
  /// From the colour camera to the left imager, towards the image's right [3].
  double imager_offset_m = 0.015;
  bool shadows = true;  ///< No depth where an imager cannot see (RemoveShadows).
  /// No depth where neighbours within a pixel differ by more: edges, and sides steeper than 77
  /// degrees at 1 m (a Kinect's noise grows without bound towards 90 [4]). 0: depth everywhere.
  /// Tuned.
  double edge_step_mm = 15;

  /// Standard deviation of each colour channel, levels of 255; tuned. The same for dark and bright:
  /// photon noise grows with the root of the light, and the curve that makes 8 bits of it falls so.
  double color_sigma = 1.5;
  double blur_px = 0.55;  ///< Standard deviation of the lens's blur of colour; tuned.
  double gain = 1;        ///< Exposure: scales every colour.
  double red_gain = 1;    ///< White balance: scales red, and
  double blue_gain = 1;   ///< blue, against green.

  template <class V>
  void Fields(V& v) {
    v("preset", preset, {"realsense", "clean"});
    v("depth_sigma_mm", depth_sigma_mm, {0, 20});
    v("depth_correlated", depth_correlated, {0, 1});
    v("disparity_step_px", disparity_step_px, {0, 1});
    v("depth_focal_px", depth_focal_px, {100, 5000});
    v("baseline_m", baseline_m, {0.01, 0.5});
    v("imager_offset_m", imager_offset_m, {0, 0.2});
    v("shadows", shadows);
    v("edge_step_mm", edge_step_mm, {0, 1000});
    v("color_sigma", color_sigma, {0, 20});
    v("blur_px", blur_px, {0, 3});
    v("gain", gain, {0.2, 2});
    v("red_gain", red_gain, {0.5, 2});
    v("blue_gain", blue_gain, {0.5, 2});
  }
};

/// Makes an ideal frame look like a RealSense D435's. Pixels without depth stay without; others
/// stay at 1 mm or more or lose it. Takes two draws from rng, whatever the frame and the preset.
/// @param fx_px  the colour camera's.
/// @throws InputError for frames wider than 5461 px.
void AddSensorNoise(RgbdFrame& frame, const SensorConfig& config, double fx_px, Rng& rng);

}  // namespace gusset
