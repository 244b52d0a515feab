#pragma once

#include "perception/camera_model.h"
#include "perception/config.h"
#include "perception/observation.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// Everything that the learner may know about a frame: state, areas, pose points. No memory between
/// frames.
///
/// A frame of 4:3 is a full view, scaled to 640x480 first; any other is taken as a bare region of
/// interest (see view.h). Depth may be empty: points then lie on the table, and a warning says so.
///
/// @param camera calibration of a full view.
/// @throws InputError (a std::invalid_argument) if colour is not CV_8UC3 or empty, depth is neither
///   empty nor CV_16UC1 of the same size, or the camera cannot be one.
[[nodiscard]] Observation Perceive(const RgbdFrame& frame, const CameraModel& camera,
                                   const PerceptionConfig& config, const BagThresholds& thresholds);

}  // namespace gusset
