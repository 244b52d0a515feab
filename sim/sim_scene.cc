#include "sim/sim_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <numbers>

#include "base/error.h"

namespace gusset {
namespace {

// The overhead camera's.
constexpr int kWidth_px = 640;
constexpr int kHeight_px = 480;

std::string Text(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

// What bounds of single values let through and no bag can be.
void CheckBag(const ConfigTree& tree, const SimConfig& config) {
  const BagConfig& bag = config.bag;
  const double most_m = bag.opening_m / bag.labels_per_layer;
  if (bag.label_width_m > most_m) {
    tree.Refuse("bag.label_width_m", bag.label_width_m,
                "is not at most " + Text(most_m) +
                    ": bag.labels_per_layer = " + std::to_string(bag.labels_per_layer) +
                    " labels do not fit side by side onto bag.opening_m = " + Text(bag.opening_m));
  }
}

// Meshes on which contact cannot tell a ply from its neighbours, or rows from columns.
void CheckMesh(const ConfigTree& tree, const BagConfig& bag) {
  constexpr double kLeastSpacing = 2;   // plies
  constexpr double kMostElongated = 4;  // cells; those of the bags here are up to 1.1
  const double across_m = bag.opening_m / (bag.nodes_across - 1);
  const double deep_m = bag.depth_m / (bag.nodes_deep - 1);
  const bool across_finer = across_m < deep_m;
  const std::string key = across_finer ? "bag.nodes_across" : "bag.nodes_deep";
  const int nodes = across_finer ? bag.nodes_across : bag.nodes_deep;
  const double finer_m = std::min(across_m, deep_m), coarser_m = std::max(across_m, deep_m);
  if (finer_m < kLeastSpacing * bag.thickness_m) {
    tree.Refuse(key, nodes,
                "puts nodes " + Text(finer_m) +
                    " m apart, less than two bag.thickness_m = " + Text(bag.thickness_m));
  }
  if (coarser_m > kMostElongated * finer_m) {
    tree.Refuse(key, nodes,
                "puts nodes " + Text(finer_m) + " m apart, less than a quarter of the " +
                    Text(coarser_m) + " m of the other direction");
  }
}

// What would be read beyond the end of this bag's lists.
void CheckFits(const ClothState& state, const ClothState& own) {
  const std::size_t nodes = own.x.size();
  if (state.x.size() != nodes) {
    throw InputError("snapshot is of a bag with " + std::to_string(state.x.size()) +
                     " nodes, this bag has " + std::to_string(nodes));
  }
  const auto is_node = [&](auto n) { return n >= 0 && static_cast<std::size_t>(n) < nodes; };
  const auto is_held = [&](int k) {
    return k >= 0 && static_cast<std::size_t>(k) < state.held.size();
  };
  const bool tethered = !state.tether_m.empty() || !state.tether_to.empty();
  const bool fits =
      state.v.size() == nodes && state.bend_set.size() == own.bend_set.size() &&
      state.stretch_set.size() == own.stretch_set.size() &&
      state.shear_set.size() == own.shear_set.size() &&
      std::ranges::all_of(
          state.held, [&](const HeldPoint& h) { return std::ranges::all_of(h.node, is_node); }) &&
      (!tethered || (state.tether_m.size() == nodes && state.tether_to.size() == nodes)) &&
      std::ranges::all_of(state.tether_to, is_held);
  if (!fits) throw InputError("snapshot is of a bag with other rows of nodes");
}

// The cube waits where the camera sees it and no bag is looked for.
void CheckCube(const ConfigTree& tree, const SimConfig& config) {
  const CameraConfig& camera = config.camera;
  const std::vector<double>& wait = config.world.cube_wait_m;
  // The camera's rows run against y.
  const double half_x_px = wait[0] > 0 ? kWidth_px - camera.cx : camera.cx;
  const double half_y_px = wait[1] > 0 ? camera.cy : kHeight_px - camera.cy;
  const double most_x = half_x_px / camera.fx * camera.height_m - config.world.cube_side_m;
  const double most_y = half_y_px / camera.fy * camera.height_m - config.world.cube_side_m;
  // Starts know nothing of the cube: corners of both, turned towards each other, must not meet.
  const double margin = 0.5 * (std::numbers::sqrt2 * config.world.cube_side_m +
                               std::hypot(config.bag.opening_m, config.bag.depth_m)) +
                        std::max(config.starts.centre_m, config.starts.any_centre_m);
  for (std::size_t k = 0; k < 2; ++k) {
    const double most = k == 0 ? most_x : most_y;
    if (std::abs(wait[k]) > most) {
      tree.Refuse("world.cube_wait_m", wait[k],
                  "is out of the camera's view, which ends " + Text(most) + " m from its middle");
    }
  }
  const double distance = std::hypot(wait[0], wait[1]);
  if (distance < margin) {
    tree.Refuse("world.cube_wait_m", distance,
                "is where the bag lies, less than " + Text(margin) + " m from the table's middle");
  }
}

void CheckStarts(const ConfigTree& tree, const SimConfig& config) {
  const StartConfig& starts = config.starts;
  if (starts.folded_area_min_px >= starts.folded_area_max_px) {
    tree.Refuse(
        "starts.folded_area_min_px", starts.folded_area_min_px,
        "is not below starts.folded_area_max_px = " + std::to_string(starts.folded_area_max_px));
  }
  const CameraConfig& camera = config.camera;
  const double flat_px = config.bag.opening_m * config.bag.depth_m * camera.fx * camera.fy /
                         (camera.height_m * camera.height_m);
  if (starts.folded_area_min_px >= flat_px) {
    tree.Refuse("starts.folded_area_min_px", starts.folded_area_min_px,
                "is not below the " + std::to_string(std::lround(flat_px)) +
                    " px that a bag of bag.opening_m = " + Text(config.bag.opening_m) +
                    ", bag.depth_m = " + Text(config.bag.depth_m) + " covers laid flat");
  }
}

}  // namespace

void SimConfig::Read(ConfigTree& tree) {
  tree.Read("bag", bag);
  tree.Read("solver", solver);
  tree.Read("world", world);
  tree.Read("robot", robot);
  tree.Read("camera", camera);
  tree.Read("sensor", sensor);
  tree.Read("light", light);
  tree.Read("variation", variation);
  tree.Read("starts", starts);
  CheckBag(tree, *this);
  CheckMesh(tree, bag);
  CheckCube(tree, *this);
  CheckStarts(tree, *this);
}

void SimConfig::AppendTo(std::string& out) const {
  AppendToml("bag", bag, out);
  AppendToml("solver", solver, out);
  AppendToml("world", world, out);
  AppendToml("robot", robot, out);
  AppendToml("camera", camera, out);
  AppendToml("sensor", sensor, out);
  AppendToml("light", light, out);
  AppendToml("variation", variation, out);
  AppendToml("starts", starts, out);
}

namespace {

// How a start was made, after its cloth.
struct StartRecord {
  std::int32_t kind, attempts, area_px;
};

// As a snapshot of a world that holds nothing else of interest, and a record.
std::string PackStart(const Start& start, const Eigen::VectorXd& q) {
  WorldState state;
  state.cloth = start.cloth;
  SimRobotState robot;
  robot.q = q;
  const StartRecord record{static_cast<std::int32_t>(start.kind), start.attempts, start.area_px};
  std::string bytes = PackSnapshot(state, robot);
  bytes.append(reinterpret_cast<const char*>(&record), sizeof record);
  return bytes;
}

Start UnpackStart(const std::string& bytes) {
  StartRecord record{};
  if (bytes.size() < sizeof record) throw InputError("a kept start is cut short");
  const std::size_t end = bytes.size() - sizeof record;
  std::memcpy(&record, bytes.data() + end, sizeof record);
  WorldState state;
  SimRobotState robot;
  UnpackSnapshot(bytes.substr(0, end), state, robot);
  return {state.cloth, static_cast<FoldKind>(record.kind), record.attempts, record.area_px};
}

}  // namespace

/// Where the arm moves: the present world, whichever that is.
class SimScene::Slot : public ArmEnvironment {
 public:
  explicit Slot(std::unique_ptr<World>& world) : world_(world) {}

  double step_s() const override { return world_->step_s(); }
  void Step(const std::vector<Eigen::Isometry3d>& X_WL, double opening_m, bool at_rest) override {
    world_->Step(X_WL, opening_m, at_rest);
    if (!callback || world_->time_s() < next_s) return;
    next_s = world_->time_s() + period_s;
    callback();
  }
  Eigen::Vector3d ForceOnTool() const override { return world_->ForceOnTool(); }
  double PadForce() const override { return world_->PadForce(); }
  bool PadsBlocked() const override { return world_->PadsBlocked(); }
  void BeginHold(double force_N) override { world_->BeginHold(force_N); }
  void EndHold() override { world_->EndHold(); }

  std::function<void()> callback;
  double period_s = 0;
  double next_s = 0;

 private:
  std::unique_ptr<World>& world_;
};

SimScene::SimScene(const SimConfig& config)
    : config_(config),
      camera_(OverheadCamera({config.camera.fx, config.camera.fy, config.camera.cx,
                              config.camera.cy, kWidth_px, kHeight_px},
                             config.camera.height_m)),
      arm_(ArmModel::Load(config.robot, AssetsFolder())),
      look_(NominalLook()),
      labels_(MakeLabels(config.bag)),
      cube_mesh_(BoxMesh(Eigen::Vector3d::Constant(config.world.cube_side_m))),
      camera_noise_(0) {
  AppendToml("bag", config_.bag, start_key_);
  AppendToml("solver", config_.solver, start_key_);
  AppendToml("camera", config_.camera, start_key_);
  AppendToml("starts", config_.starts, start_key_);
  world_ = std::make_unique<World>(config_.bag, config_.solver, config_.world, arm_);
  slot_ = std::make_unique<Slot>(world_);
  robot_ = std::make_unique<SimRobot>(arm_, *slot_, 0);
  world_->PlaceArm(robot_->X_WL(), robot_->opening_m());
}

SimScene::~SimScene() = default;

RobotPort& SimScene::robot() { return *robot_; }

double SimScene::time_s() const { return world_->time_s(); }

Start SimScene::MakeStart(StartKind kind, std::uint64_t seed) const {
  const bool folded = kind == StartKind::kFolded || kind == StartKind::kFoldedAnyPose;
  const bool any = kind == StartKind::kFoldedAnyPose || kind == StartKind::kUnfoldedAnyPose;
  const std::string key = start_key_ + "start = [" + std::to_string(folded) + ", " +
                          std::to_string(any) + ", " + std::to_string(seed) + "]";
  if (const std::optional<std::string> kept = cache_.Find(key)) return UnpackStart(*kept);
  const Start start =
      folded ? MakeFoldedStart(config_.bag, config_.solver, config_.starts, camera_, any, seed)
             : MakeUnfoldedStart(config_.bag, config_.solver, config_.starts, camera_, any, seed);
  cache_.Keep(key, PackStart(start, arm_.waiting()));
  return start;
}

void SimScene::Reset(StartKind kind, std::uint64_t seed) {
  WorldState state;
  state.cloth = MakeStart(kind, seed).cloth;
  state.cube = WaitingCube(config_.world);
  SimRobotState robot;
  robot.q = arm_.waiting();
  robot.opening_m = arm_.max_opening_m();
  Rebuild(state, robot);
  SeedNoise(seed);
  look_ = NominalLook();
  labels_ = MakeLabels(config_.bag);
}

void SimScene::SeedNoise(std::uint64_t sensor_seed) {
  robot_->SeedSensors(DeriveSeed(sensor_seed, "torque"));
  camera_noise_ = Rng(DeriveSeed(sensor_seed, "camera"));
}

void SimScene::Rebuild(const WorldState& state, const SimRobotState& robot) {
  world_ = std::make_unique<World>(config_.bag, config_.solver, config_.world, arm_);
  world_->SetState(state);
  robot_->Restore(robot);
  world_->PlaceArm(robot_->X_WL(), robot_->opening_m());
  slot_->next_s = 0;
}

SceneLook SimScene::NominalLook() const {
  SceneLook look;
  look.light = config_.light;
  const std::vector<double>& rgb = config_.bag.colour_rgb;
  look.bag_rgb = Eigen::Vector3d(rgb[0], rgb[1], rgb[2]).cast<float>();
  look.label_rgb = ClothItem().label_rgb;
  look.canvas_rgb = statics_.items()[kCanvasItem].rgb;
  look.labels_per_layer = config_.bag.labels_per_layer;
  return look;
}

Snapshot SimScene::Save() { return PackSnapshot(world_->state(), robot_->Save()); }

void SimScene::Restore(const Snapshot& snapshot, std::uint64_t sensor_seed) {
  WorldState state;
  SimRobotState robot;
  UnpackSnapshot(snapshot, state, robot);
  CheckFits(state.cloth, world_->cloth().state());
  if (robot.q.size() != arm_.waiting().size()) {
    throw InputError("snapshot is of a robot with " + std::to_string(robot.q.size()) +
                     " joints, this one has " + std::to_string(arm_.waiting().size()));
  }
  Rebuild(state, robot);
  SeedNoise(sensor_seed);
  look_ =
      Vary(NominalLook(), config_.variation, state.cube.X_WB.translation().head<2>(), sensor_seed);
  BagConfig bag = config_.bag;
  bag.labels_per_layer = look_.labels_per_layer;
  labels_ = MakeLabels(bag);
}

ClothItem SimScene::DrawnCloth() const {
  const ClothMesh& mesh = world_->cloth().mesh();
  ClothItem cloth;
  cloth.x = world_->cloth().state().x;
  cloth.triangles = mesh.triangles;
  cloth.triangle_layer = mesh.triangle_layer;
  cloth.uv = mesh.uv;
  cloth.thickness_m = mesh.thickness_m;
  cloth.rgb = look_.bag_rgb;
  cloth.label_rgb = look_.label_rgb;
  if (config_.variation.labels_drawn) cloth.labels = labels_;
  return cloth;
}

RgbdFrame SimScene::Look(const CameraModel& camera) {
  SceneView view;
  view.items = statics_.items();
  view.items[kCanvasItem].rgb = look_.canvas_rgb;
  view.light = look_.light;
  view.canvas_seed = look_.canvas_seed;
  for (const Clutter& block : look_.clutter) {
    RenderItem item;
    item.mesh = &block.mesh;
    item.X_WM = block.X_WM;
    item.still = true;
    item.rgb = block.rgb;
    view.items.push_back(item);
  }
  const std::vector<RobotLink>& links = arm_.robot().links();
  for (std::size_t l = 0; l < links.size(); ++l) {
    for (const VisualMesh& visual : links[l].visuals) {
      RenderItem item;
      item.mesh = &visual.mesh;
      item.X_WM = robot_->X_WL()[l] * visual.X_LV;
      item.rgb = visual.colour;
      view.items.push_back(item);
    }
  }
  RenderItem cube;
  cube.mesh = &cube_mesh_;
  cube.X_WM = world_->cube().X_WB;
  cube.rgb = kCubeRgb;
  cube.contrast = kCubeContrast;
  view.items.push_back(cube);

  view.cloth = DrawnCloth();
  return renderer_.Render(view, camera);
}

RgbdFrame SimScene::Look() {
  CameraModel camera = camera_;
  camera.X_WC = camera_.X_WC * look_.X_CD;
  RgbdFrame frame = Look(camera);
  AddSensorNoise(frame, config_.sensor, camera.pinhole.fx, camera_noise_);
  return frame;
}

void SimScene::Watch(double period_s, std::function<void()> callback) {
  slot_->callback = std::move(callback);
  slot_->period_s = period_s;
  slot_->next_s = world_->time_s();
}

}  // namespace gusset
