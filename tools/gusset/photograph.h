#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "perception/camera_model.h"
#include "perception/config.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// Of the camera above the table, m, for which thresholds are given.
inline constexpr double kNominalHeight_m = 1.066;

/// What a user knows of how a photograph was taken, straight down onto the table.
struct PhotographOptions {
  std::optional<cv::Rect> crop = {};    ///< The part to look at, px.
  std::optional<double> px_per_m = {};  ///< Scale at the table, before the crop (which keeps it).
  std::optional<CameraModel> camera =
      {};  ///< Calibration of the image before the crop, of any size.
};

/// A photograph brought to what Perceive expects.
struct Photograph {
  RgbdFrame frame;
  CameraModel camera;
  std::vector<std::string> warnings;  ///< What was guessed.
};

/// Pixels per metre at the table for which thresholds are given: 615 / 1.066.
double NominalPxPerMetre();

/// With px_per_m or a camera, the image is scaled to NominalPxPerMetre and cut to the view around
/// the world's origin (without a camera: around the image's or the crop's middle): 640x480 if it
/// shows that much, else the region of interest, black where the image ends. Without either it
/// stays as it is, for Perceive to guess from its shape (the testbed's own frame, if it is as
/// large), and a warning says so.
/// @throws InputError if the crop is not within the image, or the scaled image would be absurd.
Photograph PreparePhotograph(const RgbdFrame& image, const PhotographOptions& options,
                             const PerceptionConfig& config);

}  // namespace gusset
