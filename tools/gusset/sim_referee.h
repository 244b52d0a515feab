#pragma once

#include "agents/ports/referee.h"
#include "perception/config.h"
#include "sim/sim_scene.h"

namespace gusset {

/// Ground truth of a simulated scene: what the state table says of noise-free areas projected from
/// the mesh and of the true cube.
class SimReferee : public Referee {
 public:
  /// `scene` must outlive the referee.
  SimReferee(SimScene& scene, const PerceptionConfig& perception, const BagThresholds& thresholds)
      : scene_(scene), perception_(perception), thresholds_(thresholds) {}
  Truth Judge() override;
  int LayersHeld() override;

 private:
  SimScene& scene_;
  PerceptionConfig perception_;
  BagThresholds thresholds_;
};

}  // namespace gusset
