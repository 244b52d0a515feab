#include <algorithm>
#include <iostream>

#include "base/error.h"
#include "base/random.h"
#include "sim/cloth/self_contact.h"
#include "tests/validation/experiment.h"
#include "tests/validation/triangle_box.h"

namespace gusset {
namespace {

// What counts as beside the grasp, as in ClothInActions: two links from the fingers.
constexpr float kBeside_m = 0.08f;
// Cloth may sink so far into the cube's faces before it counts: half a thickness of the thickest
// cloth, and as much again that contact gives way. Between the points of the cloth that contact
// with the cube looks at, 10 mm apart, its edges and corners dent faces more deeply than that.
constexpr double kCubeSkin_m = 0.002;
constexpr double kDepthStep_m = 0.001;
constexpr double kLookEvery_s = 0.05;
constexpr int kMostActions = 20;  // of an episode

struct Found {
  long looks = 0, looked_anew = 0;
  long crossings = 0, looks_crossed = 0, crossings_at_end = 0;
  long looks_in_cube = 0, looks_in_held_cube = 0, actions_in_cube = 0;
  /// The most of something, in which action and from which state.
  struct Peak {
    double value = 0;
    int action = 0, state = 0;
  };
  Peak deepest_m, deepest_held_m, speed_m_s, stretch_beside, stretch_elsewhere;
  int actions = 0, starts = 0, stopped = 0;
  std::array<int, 4> in_state{};
};

// N random actions, one after the other as the camera sees the states, and everything that cloth
// must not do counted on the way.
class CrossingsExperiment final : public Command {
 public:
  explicit CrossingsExperiment(std::string command) : command_(std::move(command)) {}
  const char* name() const override { return "crossings"; }
  const char* summary() const override {
    return "Crossings, overstretch and speeds in random chained actions";
  }

  void Declare(CLI::App& app) override {
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file")
        ->capture_default_str();
    app.add_option("--actions", actions_, "How many")
        ->check(CLI::Range(1, 1000000))
        ->capture_default_str();
    app.add_option("--seed", seed_, "Seed of starts, actions and noise")->capture_default_str();
    common_.AddTo(app);
  }

  void Run() override {
    Rig rig(LoadSettings(common_, {.bag = bag_}));
    rig.scene.Watch(kLookEvery_s, [&] { Look(rig); });
    Snapshot world;
    int in_episode = kMostActions;
    const std::vector<int> n_actions = rig.env.ActionCounts();
    while (found_.actions < actions_) {
      if (in_episode == kMostActions) {
        const auto kind = found_.starts % 2 == 0 ? StartKind::kFolded : StartKind::kUnfolded;
        world = rig.env.Start(kind, DeriveSeed(seed_, "crossings start", Index(found_.starts)));
        ++found_.starts;
        in_episode = 0;
      }
      const std::uint64_t index = Index(found_.actions + 1000000 * found_.starts);
      const int state = rig.env.Begin(world, DeriveSeed(seed_, "crossings sensors", index)).state;
      if (state >= static_cast<int>(n_actions.size())) {
        in_episode = kMostActions;
        continue;
      }
      Rng rng(DeriveSeed(seed_, "crossings action", index));
      ++found_.actions;
      ++in_episode;
      ++found_.in_state[static_cast<std::size_t>(state)];
      in_cube_ = false;
      state_ = state;
      try {
        Outcome outcome = rig.env.Act(rng.Below(n_actions[static_cast<std::size_t>(state)]));
        Look(rig);
        found_.crossings_at_end += crossings_;
        world = std::move(outcome.after);
        if (outcome.done) in_episode = kMostActions;
      } catch (const RunError& e) {
        ++found_.stopped;
        std::cerr << "action " << found_.actions << ": " << e.what() << std::endl;
        in_episode = kMostActions;
      }
      found_.actions_in_cube += in_cube_;
      if (found_.actions % 100 == 0) std::cerr << found_.actions << " actions" << std::endl;
    }
    rig.scene.Watch(0, {});
    Print(rig);
  }

 private:
  static std::uint64_t Index(int n) { return static_cast<std::uint64_t>(n); }

  void Look(Rig& rig) {
    const World& world = rig.scene.world();
    const ClothMesh& mesh = world.cloth().mesh();
    const Vec3Array& x = world.cloth().state().x;
    ++found_.looks;
    const Eigen::Isometry3d X_WCube = world.cube().X_WB;
    // What lies still was counted before.
    if (x != last_x_ || !X_WCube.isApprox(last_cube_, 0)) {
      ++found_.looked_anew;
      last_x_ = x;
      last_cube_ = X_WCube;
      crossings_ = CountCrossings(mesh, x);
      in_cube_m_ = DepthInCube(mesh, x, X_WCube, world.config().cube_side_m);
      const Vec3f tip = rig.scene.robot().Read().X_WT.translation().cast<float>();
      for (const ClothLink& link : mesh.stretch) {
        const bool beside = (0.5f * (x[link.a] + x[link.b]) - tip).norm() < kBeside_m;
        Raise(beside ? found_.stretch_beside : found_.stretch_elsewhere,
              (x[link.a] - x[link.b]).norm() / link.rest_m);
      }
    }
    found_.crossings += crossings_;
    found_.looks_crossed += crossings_ > 0;
    // A gripper that holds the cube presses cloth into it that is caught between them.
    Raise(world.cube_held() ? found_.deepest_held_m : found_.deepest_m, in_cube_m_);
    if (in_cube_m_ >= kCubeSkin_m) {
      ++(world.cube_held() ? found_.looks_in_held_cube : found_.looks_in_cube);
      in_cube_ = true;
    }
    Raise(found_.speed_m_s, world.cloth().MaxSpeed());
  }

  void Raise(Found::Peak& peak, double value) const {
    if (value > peak.value) peak = {value, found_.actions, state_};
  }

  // How deep cloth is in the cube, in whole steps: half a side when it cuts the cube in two.
  static double DepthInCube(const ClothMesh& mesh, const Vec3Array& x,
                            const Eigen::Isometry3d& X_WC, double side_m) {
    const Eigen::Isometry3d X_CW = X_WC.inverse();
    double depth_m = 0;
    for (const std::array<int, 3>& t : mesh.triangles) {
      const auto at = [&](int k) { return Eigen::Vector3d(X_CW * x[t[k]].cast<double>()); };
      for (double d = depth_m; d < 0.5 * side_m; d += kDepthStep_m) {
        if (!TriangleMeetsBox(at(0), at(1), at(2), Eigen::Vector3d::Constant(0.5 * side_m - d))) {
          break;
        }
        depth_m = d;
      }
    }
    return depth_m;
  }

  void Print(const Rig& rig) const {
    const auto text = [](auto n) { return std::to_string(n); };
    const auto peak = [&](const Found::Peak& p, double unit = 1) {
      return Number(p.value / unit) + " (action " + text(p.action) + ", s" + text(p.state) + ")";
    };
    const Found& f = found_;
    const std::vector<std::vector<std::string>> rows = {
        {"", bag_ + ", " + text(rig.scene.world().cloth().mesh().node_count()) + " nodes, " +
                 text(rig.scene.config().solver.substeps_per_s) + " substeps/s"},
        {"---", "---"},
        {"actions (s0, s1, s2, s3), starts",
         text(f.actions) + " (" + text(f.in_state[0]) + ", " + text(f.in_state[1]) + ", " +
             text(f.in_state[2]) + ", " + text(f.in_state[3]) + "), " + text(f.starts)},
        {"looks; since which anything moved", text(f.looks) + "; " + text(f.looked_anew)},
        {"edges through faces, summed over looks; looks with any; at actions' ends",
         text(f.crossings) + "; " + text(f.looks_crossed) + "; " + text(f.crossings_at_end)},
        {"looks with cloth 2 mm or more in the cube; deepest (mm)",
         text(f.looks_in_cube) + "; " + peak(f.deepest_m, 0.001)},
        {"the same while the gripper holds the cube",
         text(f.looks_in_held_cube) + "; " + peak(f.deepest_held_m, 0.001)},
        {"actions with either", text(f.actions_in_cube)},
        {"fastest node (m/s)", peak(f.speed_m_s)},
        {"largest stretch within 80 mm of the fingertips; elsewhere",
         peak(f.stretch_beside) + "; " + peak(f.stretch_elsewhere)},
        {"worlds stopped", text(f.stopped)}};
    std::cout << "`" << command_ << "`\n\n";
    for (const std::vector<std::string>& row : rows) std::cout << Row(row) << "\n";
    std::cout << std::flush;
  }

  std::string command_;
  CommonOptions common_;
  std::string bag_ = "bag1";
  int actions_ = 40;
  std::uint64_t seed_ = 1;
  Found found_;
  Vec3Array last_x_;
  Eigen::Isometry3d last_cube_ = Eigen::Isometry3d::Identity();
  int crossings_ = 0;
  double in_cube_m_ = 0;
  bool in_cube_ = false;
  int state_ = 0;
};

}  // namespace

std::unique_ptr<Command> MakeCrossingsExperiment(std::string command) {
  return std::make_unique<CrossingsExperiment>(std::move(command));
}

}  // namespace gusset
