#pragma once

#include <functional>
#include <memory>
#include <string>

#include "agents/ports/camera_port.h"
#include "agents/ports/scene_port.h"
#include "base/config.h"
#include "sim/render/renderer.h"
#include "sim/render/sensor.h"
#include "sim/render/statics.h"
#include "sim/render/variation.h"
#include "sim/robot/sim_robot.h"
#include "sim/snapshot.h"
#include "sim/start_cache.h"
#include "sim/starts.h"
#include "sim/top_view.h"
#include "sim/world.h"

namespace gusset {

/// The overhead camera. RealSense D435-like intrinsics at 640x480.
struct CameraConfig {
  double height_m =
      1.066;  ///< 577 px/m at the table: a flat bag covers what it does in figure 5.2.
  double fx = 615, fy = 615, cx = 320, cy = 240;

  template <class V>
  void Fields(V& v) {
    v("height_m", height_m, Range{0.3, 5});
    v("fx", fx, Range{100, 5000});
    v("fy", fy, Range{100, 5000});
    v("cx", cx, Range{0, 640});
    v("cy", cy, Range{0, 480});
  }
};

/// Every setting of the simulated scene, a section each.
struct SimConfig {
  BagConfig bag;
  ClothSolverConfig solver;
  WorldConfig world;
  RobotConfig robot;
  CameraConfig camera;
  SensorConfig sensor;
  LightConfig light;
  VariationConfig variation;
  StartConfig starts;

  /// Reads all sections and checks what bounds alone cannot. @throws InputError.
  void Read(ConfigTree& tree);
  void AppendTo(std::string& out) const;
};

/// The simulated rig behind the ports: world, arm and camera. Restore and Reset build a new world;
/// the ports stay the same objects.
class SimScene : public ScenePort, public CameraPort {
 public:
  explicit SimScene(const SimConfig& config);
  ~SimScene() override;

  void Reset(StartKind kind, std::uint64_t seed) override;
  Snapshot Save() override;
  void Restore(const Snapshot& snapshot, std::uint64_t sensor_seed) override;
  double time_s() const override;

  /// The camera as calibrated; where variation moves it, nobody knows.
  const CameraModel& model() const override { return camera_; }
  RgbdFrame Look() override;
  /// Without noise, from any camera.
  RgbdFrame Look(const CameraModel& camera);

  RobotPort& robot();
  const World& world() const { return *world_; }
  World& world() { return *world_; }
  const SimConfig& config() const { return config_; }
  const std::vector<LabelPatch>& labels() const { return labels_; }
  std::string gl_renderer() const { return renderer_.gl_renderer(); }
  /// The cloth in its present shape as Look draws it.
  ClothItem DrawnCloth() const;
  /// From now on calls `callback` after every period_s of simulated time.
  void Watch(double period_s, std::function<void()> callback);
  /// From now on the bag is drawn with its labels or without, as variation.labels_drawn says at
  /// first. labels() and all else stay as they are.
  void DrawLabels(bool drawn) { config_.variation.labels_drawn = drawn; }
  /// The start that Reset uses, made or found in the cache.
  Start MakeStart(StartKind kind, std::uint64_t seed) const;

 private:
  class Slot;
  void Rebuild(const WorldState& state, const SimRobotState& robot);
  void SeedNoise(std::uint64_t sensor_seed);
  SceneLook NominalLook() const;

  SimConfig config_;
  CameraModel camera_;
  ArmModel arm_;
  Statics statics_;
  SceneLook look_;
  std::vector<LabelPatch> labels_;
  Renderer renderer_;
  TriMesh cube_mesh_;
  StartCache cache_;
  std::string start_key_;
  std::unique_ptr<World> world_;
  std::unique_ptr<Slot> slot_;
  std::unique_ptr<SimRobot> robot_;
  Rng camera_noise_;
};

}  // namespace gusset
