#include "tools/gusset/wiring.h"

#include "agents/bagging_env.h"
#include "sim/sim_scene.h"
#include "tools/gusset/sim_referee.h"

namespace gusset {
namespace {

// From the front right, above the table: the pictures of the thesis's primitives.
CameraModel ObliqueCamera() {
  return LookAt({0.75, 0.80, 0.75}, {0, -0.08, 0.12}, {560, 560, 320, 240, 640, 480});
}

class SimTestbed : public Testbed {
 public:
  SimTestbed(const SimConfig& config, const PerceptionConfig& perception,
             const BagThresholds& thresholds)
      : scene_(config), referee_(scene_, perception, thresholds) {}

  ScenePort& scene() override { return scene_; }
  CameraPort& camera() override { return scene_; }
  RobotPort& robot() override { return scene_.robot(); }
  Referee& referee() override { return referee_; }
  RgbdFrame ObliqueLook() override { return scene_.Look(ObliqueCamera()); }
  void Watch(double period_s, std::function<void()> callback) override {
    scene_.Watch(period_s, std::move(callback));
  }
  void AppendConfig(std::string& out) const override { scene_.config().AppendTo(out); }
  std::string renderer() const override { return scene_.gl_renderer(); }

 private:
  SimScene scene_;
  SimReferee referee_;
};

}  // namespace

std::unique_ptr<Testbed> MakeTestbed(ConfigTree& config) {
  SimConfig sim;
  sim.Read(config);
  BaggingConfig bagging;
  bagging.Read(config);
  // Perception looks for as many labels as the bag has.
  const int labels = bagging.chosen_thresholds().labels_per_layer;
  if (labels != sim.bag.labels_per_layer) {
    const char* section =
        bagging.thresholds.source == "published" ? "thresholds_published" : "thresholds";
    config.Refuse(std::string(section) + ".labels_per_layer", labels,
                  "is not bag.labels_per_layer = " + std::to_string(sim.bag.labels_per_layer));
  }
  return std::make_unique<SimTestbed>(sim, bagging.perception, bagging.chosen_thresholds());
}

}  // namespace gusset
