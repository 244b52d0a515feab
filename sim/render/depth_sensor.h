#pragma once

#include <opencv2/core.hpp>

#include "base/random.h"
#include "sim/render/sensor.h"

namespace gusset {

/// What a pair of infrared imagers beside the colour camera makes of an ideal depth image
/// (CV_16UC1, mm, aligned to colour, 0: nothing there). Every function works in place.

/// Takes the depth from where one of the imagers cannot see, as a pixel of the aligned image then
/// has none. The imagers lie to the right of the colour camera, so the shadow falls to the left of
/// whatever stands out: of a step from z_far to z_near, the floor(w) pixels before it, where
/// w = fx b (1/z_near - 1/z_far) (one fewer if w is whole) and b is the farther imager's distance
/// from the colour camera.
///
/// Seen from b to the right, pixel u of a row lies at s(u) = u - fx b / z(u). It is hidden if some
/// pixel on its right has got to its left: s(u) > s(u') for a u' > u. What is hidden from the
/// nearer imager is then hidden from the farther one too: u' - u < b_near k < b_far k for the same
/// k = fx (1/z' - 1/z), so that one pass is enough.
void RemoveShadows(cv::Mat& depth_mm, double fx_px, double b_m);

/// Takes the depth from pixels whose 3x3 neighbours differ by more than step_mm: windows that
/// straddle an edge match in neither image. 0: does nothing.
void RemoveEdges(cv::Mat& depth_mm, double step_mm);

/// Noise and steps of the disparity d = f B / z; see SensorConfig.
void AddDisparityNoise(cv::Mat& depth_mm, const SensorConfig& config, Rng& rng);

}  // namespace gusset
