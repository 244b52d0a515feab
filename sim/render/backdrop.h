#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "perception/camera_model.h"
#include "perception/rgbd_frame.h"
#include "sim/render/bounds.h"
#include "sim/render/scene_view.h"

namespace gusset {

/// A frame of what stands still: table, canvas, pedestal, clutter. It is four fifths of what the
/// overhead camera sees, and the same in every frame; only where something moves, or its shadow
/// falls, need a frame be drawn.
class Backdrop {
 public:
  /// True if the last two calls were of the same view: the second time a frame is worth keeping.
  /// What is kept of another view is forgotten.
  bool IsWorthIt(const SceneView& still, const CameraModel& camera);

  bool kept() const { return frame_.has_value(); }
  const RgbdFrame& frame() const { return *frame_; }
  void Keep(RgbdFrame frame);

  /// The parts of the frame, none of which overlap, outside which a scene looks like the backdrop.
  /// @param moving, still boxes around what does and what does not stand still, world.
  /// @param shear see the renderer's ground map: a point casts its shadow on all that have the same
  /// xy - z shear.
  /// @param blur_m how much further a shadow reaches.
  /// @param map_half_m beyond this x or y of the ground map all is as at its border.
  std::vector<cv::Rect> ChangedParts(const std::vector<Corners>& moving,
                                     const std::vector<Corners>& still,
                                     const Eigen::Matrix4f& clip_from_world,
                                     const Eigen::Vector2f& shear, float blur_m,
                                     float map_half_m) const;

 private:
  bool IsOf(const SceneView& still, const CameraModel& camera) const;

  SceneView still_;  ///< Its items' meshes are the copies below.
  std::vector<TriMesh> meshes_;
  CameraModel camera_;
  std::optional<RgbdFrame> frame_;
  float lowest_m_ = 0;  ///< Height of the lowest thing that the frame shows.
};

}  // namespace gusset
