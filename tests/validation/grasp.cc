#include <cmath>
#include <iostream>
#include <optional>
#include <set>

#include "base/random.h"
#include "sim/robot/tool_pose.h"
#include "tests/validation/experiment.h"

namespace gusset {
namespace {

constexpr double kStep_m = 0.00025;
constexpr int kHeights = 17;           // 0 to 4 mm
constexpr double kAbove_m = 0.10;      // comes down from here
constexpr double kFromEdges_m = 0.04;  // of the flat pattern: two layers, no seam, no hem
constexpr double kMostReach_m = 0.20;  // from the table's middle, where the tool stands upright

struct Counts {
  int none = 0, one = 0, both = 0, unreachable = 0;
  int tried() const { return none + one + both; }
  double Share(int n) const { return tried() == 0 ? 0 : static_cast<double>(n) / tried(); }
};

// Heights (m) where a share that was measured at 0, kStep_m, ... passes one half, interpolated.
std::vector<double> HalfAt(const std::vector<double>& share) {
  std::vector<double> heights;
  for (std::size_t i = 0; i + 1 < share.size(); ++i) {
    if ((share[i] < 0.5) == (share[i + 1] < 0.5)) continue;
    const double part = (0.5 - share[i]) / (share[i + 1] - share[i]);
    heights.push_back((static_cast<double>(i) + part) * kStep_m);
  }
  return heights;
}

// Fingers that come down wide open on a flat bag to a height, close along the rim, and hold one
// layer, both or none.
class GraspExperiment final : public Command {
 public:
  explicit GraspExperiment(std::string command) : command_(std::move(command)) {}
  const char* name() const override { return "grasp"; }
  const char* summary() const override {
    return "Layers held against the fingertips' height over a flat bag";
  }

  void Declare(CLI::App& app) override {
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file")
        ->capture_default_str();
    app.add_option("--samples", samples_, "Starts and places at each height")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--seed", seed_, "Seed of starts and places")->capture_default_str();
    common_.AddTo(app);
  }

  void Run() override {
    Rig rig(LoadSettings(common_, {.bag = bag_}));
    std::vector<Counts> counts(kHeights);
    for (int s = 0; s < samples_; ++s) {
      const auto index = static_cast<std::uint64_t>(s);
      rig.scene.Reset(StartKind::kUnfolded, DeriveSeed(seed_, "grasp start", index));
      const Snapshot start = rig.scene.Save();
      // All heights at the same place of the same bag.
      const Place place = Choose(rig.scene.world(), rig.scene.config().bag, index);
      for (int k = 0; k < kHeights; ++k) {
        rig.scene.Restore(start, DeriveSeed(seed_, "grasp sensors", index));
        const std::optional<int> layers = Grasp(rig, place, k * kStep_m);
        Counts& c = counts[static_cast<std::size_t>(k)];
        if (!layers) {
          ++c.unreachable;
        } else {
          ++(*layers == 0 ? c.none : *layers == 1 ? c.one : c.both);
        }
      }
    }
    Print(counts, rig.scene.config().bag);
  }

 private:
  struct Place {
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();
    double along_rad = 0;  // of the rim
  };

  // A point of the flat pattern away from its edges, where the start has it.
  Place Choose(const World& world, const BagConfig& bag, std::uint64_t index) const {
    Rng rng(DeriveSeed(seed_, "grasp place", index));
    const ClothMesh& mesh = world.cloth().mesh();
    const Vec3Array& x = world.cloth().state().x;
    for (;;) {
      const Eigen::Vector2f uv(
          static_cast<float>(rng.Uniform(kFromEdges_m, bag.opening_m - kFromEdges_m)),
          static_cast<float>(rng.Uniform(kFromEdges_m, bag.depth_m - kFromEdges_m)));
      for (const std::array<int, 3>& t : mesh.triangles) {
        Eigen::Matrix2f edges;
        edges << mesh.uv[t[1]] - mesh.uv[t[0]], mesh.uv[t[2]] - mesh.uv[t[0]];
        const Eigen::Vector2f w = edges.inverse() * (uv - mesh.uv[t[0]]);
        if (w.minCoeff() < 0 || w.sum() > 1) continue;
        const Vec3f p = x[t[0]] + w[0] * (x[t[1]] - x[t[0]]) + w[1] * (x[t[2]] - x[t[0]]);
        const Vec3f rim = x[bag.nodes_across - 1] - x[0];
        if (p.head<2>().norm() > kMostReach_m) break;
        return {Eigen::Vector3d(p.x(), p.y(), 0), std::atan2(rim.y(), rim.x())};
      }
    }
  }

  // @returns distinct layers held; nothing where the arm could not do it.
  std::optional<int> Grasp(Rig& rig, const Place& place, double height_m) const {
    const MotionConfig& motion = rig.settings.bagging.motion;
    RobotPort& robot = rig.scene.robot();
    Eigen::Isometry3d X_WT = DownwardPose(place.p_W, place.along_rad);
    robot.MoveGripper(robot.max_opening_m(), motion.finger_speed_m_s, motion.grip_force_N);
    const auto move = [&](double z, double speed_m_s) {
      X_WT.translation().z() = z;
      const MoveResult result = robot.MoveTo(X_WT, speed_m_s);
      X_WT = result.X_WT;
      return result.end == MoveEnd::kReached;
    };
    if (!move(kAbove_m, motion.travel_speed_m_s) || !move(0.02, motion.descend_speed_m_s) ||
        !move(height_m, motion.guarded_speed_m_s)) {
      return std::nullopt;
    }
    robot.MoveGripper(0, motion.finger_speed_m_s, motion.grip_force_N);
    std::set<int> layers;
    for (const HeldPoint& held : rig.scene.world().cloth().state().held) layers.insert(held.layer);
    return static_cast<int>(layers.size());
  }

  void Print(const std::vector<Counts>& counts, const BagConfig& bag) const {
    std::cout << "`" << command_ << "`\n\n"
              << "| fingertips (mm) | grasps | both | one | none | out of reach or stopped |\n"
              << "|---|---|---|---|---|---|\n";
    std::vector<double> both, one, any;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      const Counts& c = counts[k];
      both.push_back(c.Share(c.both));
      one.push_back(c.Share(c.one));
      any.push_back(c.Share(c.one + c.both));
      std::cout << Row({Number(1000 * kStep_m * static_cast<double>(k), "%.2f"),
                        std::to_string(c.tried()), Number(both.back(), "%.2f"),
                        Number(one.back(), "%.2f"), Number(1 - any.back(), "%.2f"),
                        std::to_string(c.unreachable)})
                << "\n";
    }
    const auto list = [](const std::vector<double>& heights) {
      std::string text;
      for (const double h : heights) text += (text.empty() ? "" : ", ") + Number(1000 * h, "%.2f");
      return text.empty() ? std::string("nowhere") : text;
    };
    std::cout << "\n| bag | thickness (mm) | P(both) = 1/2 at (mm) | P(one) = 1/2 at (mm) | "
                 "P(none) = 1/2 at (mm) |\n|---|---|---|---|---|\n"
              << Row({bag_, Number(1000 * bag.thickness_m, "%.2f"), list(HalfAt(both)),
                      list(HalfAt(one)), list(HalfAt(any))})
              << std::endl;
  }

  std::string command_;
  CommonOptions common_;
  std::string bag_ = "bag1";
  int samples_ = 10;
  std::uint64_t seed_ = 1;
};

}  // namespace

std::unique_ptr<Command> MakeGraspExperiment(std::string command) {
  return std::make_unique<GraspExperiment>(std::move(command));
}

}  // namespace gusset
