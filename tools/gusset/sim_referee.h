#pragma once

#include <optional>

#include "agents/ports/referee.h"
#include "perception/config.h"
#include "sim/render/cloth_surface.h"
#include "sim/sim_scene.h"
#include "tools/gusset/frame_truth.h"

namespace gusset {

/// Ground truth of a simulated scene: what the state table says of noise-free areas of the cloth as
/// cameras see it and of the true cube, which is seen where at least as many of its pixels are as
/// perception needs. What is held and whether the cube is in the bag is the simulation's to say.
class SimReferee : public Referee {
 public:
  /// `scene` must outlive the referee.
  SimReferee(SimScene& scene, const PerceptionConfig& perception, const BagThresholds& thresholds)
      : scene_(scene), perception_(perception), thresholds_(thresholds) {}
  Truth Judge() override { return Describe().truth; }
  /// The same with what it rests on, pixel by pixel.
  FrameTruth Describe();
  int LayersHeld() override;

 private:
  SimScene& scene_;
  PerceptionConfig perception_;
  BagThresholds thresholds_;
  std::optional<ClothSurface> drawn_;  // kept for its topology
};

}  // namespace gusset
