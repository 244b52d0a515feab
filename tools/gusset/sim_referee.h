#pragma once

#include "agents/ports/referee.h"
#include "perception/config.h"
#include "sim/sim_scene.h"
#include "tools/gusset/frame_truth.h"

namespace gusset {

/// Ground truth of a simulated scene: what the state table says of noise-free areas projected from
/// the mesh and of the true cube, which is seen where at least as many of its pixels are as
/// perception needs.
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
};

}  // namespace gusset
