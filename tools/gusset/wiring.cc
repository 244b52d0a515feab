#include "tools/gusset/wiring.h"

#include <spdlog/fmt/fmt.h>

#include <numbers>

#include "agents/bagging_env.h"
#include "base/gravity.h"
#include "base/random.h"
#include "sim/cloth/bag_mesh.h"
#include "sim/sim_scene.h"
#include "tools/gusset/sim_referee.h"

namespace gusset {
namespace {

// From the front right, above the table: the pictures of the thesis's primitives.
CameraModel ObliqueCamera() {
  return LookAt({0.75, 0.80, 0.75}, {0, -0.08, 0.12}, {560, 560, 320, 240, 640, 480});
}

// Where a bag taken off the table is: out of every frame.
constexpr float kAway_m = 3;
// Within the region of interest, which reaches 0.295 m from its middle, less the cube itself.
constexpr double kCubeSpread_m = 0.27;
// Beside it, left or right, in the frame, which reaches 0.55 m to the sides and 0.41 m up and down.
constexpr double kBesideFrom_m = 0.34, kBesideTo_m = 0.51, kBesideSpread_m = 0.38;

class SimTestbed : public Testbed {
 public:
  SimTestbed(const SimConfig& config, const PerceptionConfig& perception,
             const BagThresholds& thresholds)
      : scene_(config), referee_(scene_, perception, thresholds) {}

  ScenePort& scene() override { return scene_; }
  CameraPort& camera() override { return scene_; }
  RobotPort& robot() override { return scene_.robot(); }
  Referee& referee() override { return referee_; }
  FrameTruth Describe() override { return referee_.Describe(); }
  void ClearTable(bool in_middle, std::uint64_t seed) override {
    World& world = scene_.world();
    ClothState cloth = world.cloth().state();
    for (Vec3f& p : cloth.x) p.x() += kAway_m;
    world.cloth().SetState(std::move(cloth));
    Rng rng(DeriveSeed(seed, "cube"));
    BodyState cube;
    double x = rng.Uniform(-kCubeSpread_m, kCubeSpread_m);
    double y = rng.Uniform(-kCubeSpread_m, kCubeSpread_m);
    if (!in_middle) {
      x = rng.Uniform(kBesideFrom_m, kBesideTo_m) * (rng.Below(2) == 0 ? -1 : 1);
      y = rng.Uniform(-kBesideSpread_m, kBesideSpread_m);
    }
    cube.X_WB.translation() << x, y, 0.5 * world.config().cube_side_m;
    cube.X_WB.linear() =
        Eigen::AngleAxisd(rng.Uniform(0, std::numbers::pi / 2), Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
    world.SetCube(cube);
  }
  void DrawLabels(bool drawn) override { scene_.DrawLabels(drawn); }
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

// The carry weighs the bag to tell whether the cube is in it. Another bag's limit would say so of
// all, or of none.
void RefuseLimitOfAnotherBag(const ConfigTree& config, double filled_N, const SimConfig& sim) {
  double bag_kg = 0;
  for (const float node_kg : MakeBagMesh(sim.bag).mass_kg) bag_kg += node_kg;
  const double empty_N = kGravity_m_s2 * bag_kg;
  const double full_N = empty_N + kGravity_m_s2 * sim.world.cube_mass_kg;
  if (filled_N == 0 || (filled_N > empty_N && filled_N < full_N)) return;
  config.Refuse("primitives.close_carry.filled_N", filled_N,
                fmt::format("is not between {:.2f} N, what the bag weighs, and {:.2f} N, what it "
                            "weighs with the cube in it (0: not weighed)",
                            empty_N, full_N));
}

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
  RefuseLimitOfAnotherBag(config, bagging.close_carry.filled_N, sim);
  return std::make_unique<SimTestbed>(sim, bagging.perception, bagging.chosen_thresholds());
}

}  // namespace gusset
