#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "agents/ports/referee.h"
#include "perception/camera_model.h"
#include "perception/config.h"
#include "perception/observation.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// One look of the camera: the frame, what perception made of it, and what was true.
struct Look {
  RgbdFrame frame;
  Observation seen;
  Truth truth;
};

/// Writes STEM.png (colour), STEM_depth.png (16 bit, mm), STEM_overlay.png (the region of interest
/// as DrawOverlay draws it) and STEM_masks.png (as large as the frame: red where the colour is the
/// cube's, green where a label's, blue where the cloth's).
/// @returns its labels: state, areas in px^2, label centroids and cube in px, each as seen, and
///   state_true, A_bag_true, A_o_true by ground truth.
/// @throws InputError if the place cannot be written, RunError if writing fails (disk full).
nlohmann::ordered_json WriteLook(const std::string& stem, const Look& look,
                                 const CameraModel& camera, const PerceptionConfig& config);

}  // namespace gusset
