#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "agents/ports/camera_port.h"
#include "agents/ports/referee.h"
#include "agents/ports/robot_port.h"
#include "agents/ports/scene_port.h"
#include "base/config.h"
#include "tools/gusset/frame_truth.h"

namespace gusset {

/// Everything that stands for the rig: here the simulated one, elsewhere a real one could.
class Testbed {
 public:
  virtual ~Testbed() = default;
  virtual ScenePort& scene() = 0;
  virtual CameraPort& camera() = 0;
  virtual RobotPort& robot() = 0;
  virtual Referee& referee() = 0;

  /// Ground truth of what the camera sees now, for labelled frames.
  virtual FrameTruth Describe() = 0;
  /// What a person would do to clear the table, for labelled frames of s4 and s5: takes the bag
  /// away, out of the frame, and lays the cube somewhere in the middle of the table, or beside the
  /// middle, left or right. No time passes.
  virtual void ClearTable(bool in_middle, std::uint64_t seed) = 0;
  /// From now on the bag is drawn with its labels, or without. Ground truth still goes by where
  /// they would be.
  virtual void DrawLabels(bool drawn) = 0;
  /// The whole scene from the side, for people; without noise. No time passes.
  virtual RgbdFrame ObliqueLook() = 0;
  /// From now on calls `callback` after every period_s of simulated time, while the world moves.
  /// It may look, and must not change anything. An empty function ends it.
  virtual void Watch(double period_s, std::function<void()> callback) = 0;
  /// Appends every section of the world's config as it took effect.
  virtual void AppendConfig(std::string& out) const = 0;
  /// What draws the frames (GL_RENDERER).
  virtual std::string renderer() const = 0;
};

/// The one place where the simulation meets the agents: builds arm, world, camera and referee from
/// the config's sections. One thread may use what it returns, the one that called this.
/// @param config holds the bag's file already; what is read of it is marked as known.
/// @throws InputError for bad values and files.
std::unique_ptr<Testbed> MakeTestbed(ConfigTree& config);

}  // namespace gusset
