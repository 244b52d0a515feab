#pragma once

#include <memory>
#include <string>

#include "perception/camera_model.h"
#include "perception/rgbd_frame.h"
#include "sim/render/scene_view.h"

namespace gusset {

/// Draws scenes off screen with OSMesa (llvmpipe, OpenGL 3.3 core). Needs no display and no GPU.
///
/// Unless LP_NUM_THREADS is set, Mesa gets no threads of its own: runs are parallel by process.
/// A frame is a function of its arguments alone, bit for bit, whatever was drawn before; uploads
/// are cached, but compared with the mesh at every use. One Renderer per thread at a time.
class Renderer {
 public:
  /// @throws RunError if OSMesa gives no 3.3 core context.
  Renderer();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// An ideal frame: no sensor noise (see AddSensorNoise). Colour and depth show the same surface
  /// at the same pixel; a pixel shows the scene at its centre. Depth is rounded to the nearest mm;
  /// 0 where there is nothing within 0.05 m .. 12 m.
  /// @throws InputError if the cloth's arrays do not fit together or hold NaN.
  RgbdFrame Render(const SceneView& scene, const CameraModel& camera);

  /// GL_RENDERER, for run records and golden images.
  std::string gl_renderer() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// A camera at `eye` (m, world) looking at `target`, image up towards world +z (towards +y if it
/// looks straight down or up).
CameraModel LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                   const Pinhole& pinhole);

}  // namespace gusset
