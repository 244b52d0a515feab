#pragma once

#include "perception/camera_model.h"
#include "perception/config.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// A frame brought to the scale in which thresholds are given: a full 640x480 view, or the bare
/// region of interest.
struct View {
  RgbdFrame frame;                ///< Shares the caller's pixels where no scaling was needed.
  CameraModel camera;             ///< Calibrated for `frame`.
  cv::Rect roi;                   ///< Region of interest in `frame`.
  bool has_surroundings = false;  ///< True for a full view.
  bool scaled = false;            ///< The caller's frame had another size.
};

/// Size of a full view.
inline constexpr int kFrameWidth = 640;
inline constexpr int kFrameHeight = 480;

/// Scales a colour image to 640x480 if its sides are as 4:3 (within 1 %), else its middle square to
/// roi_side x roi_side.
cv::Mat ScaleToView(const cv::Mat& color, int roi_side);

/// @param camera calibration of a full view of any size; scaled and cropped along.
/// @throws InputError as Perceive does.
View MakeView(const RgbdFrame& frame, const CameraModel& camera, const PerceptionConfig& config);

}  // namespace gusset
