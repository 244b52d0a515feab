#pragma once

#include "perception/camera_model.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// An overhead RGB-D camera, simulated or real.
class CameraPort {
 public:
  virtual ~CameraPort() = default;
  /// The calibration a real rig would have: intrinsics and pose in the world (table) frame.
  virtual const CameraModel& model() const = 0;
  /// Takes one frame now. No time passes.
  virtual RgbdFrame Look() = 0;
};

}  // namespace gusset
