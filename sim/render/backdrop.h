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
  /// Takes note of a look at what stands still, and forgets what was kept of another view.
  /// @returns whether a frame of this one is worth keeping: from the third look in a row on, for
  /// where each world has a light of its own (`variation`), many have but two.
  bool NoteLook(const SceneView& still, const CameraModel& camera);

  bool kept() const { return frame_.has_value(); }
  const RgbdFrame& frame() const { return *frame_; }
  void Keep(RgbdFrame frame);

  /// The parts of the frame, none of which overlap, outside which a scene looks like the backdrop,
  /// of which a frame must be kept.
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
  int looks_ = 0;
  std::optional<RgbdFrame> frame_;
  float lowest_m_ = 0;  ///< Height of the lowest thing that the frame shows.
};

}  // namespace gusset
