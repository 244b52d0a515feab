// What the loop spends its time on, with Bag 1 as it is by default. Not run by ctest:
//   nice cmake --build build --target gusset_bench && build/tests/gusset_bench

#include <benchmark/benchmark.h>

#include <cmath>

#include "sim/robot/ik.h"
#include "sim/robot/tool_pose.h"
#include "tools/gusset/bench/looks.h"

namespace gusset {
namespace {

const Settings& BagOne() {
  static const Settings settings = LoadSettings({}, {.bag = "bag1"});
  return settings;
}

SimConfig Sim() { return SimConfigOf(BagOne()); }

// A world at rest would sleep; here every substep is done. `radius_m`: of the circle, 0.15 m above
// the table, along which the bag's middle is carried at 0.3 m/s; 0: the bag lies.
void ClothSubstep(benchmark::State& state, StartKind kind, float radius_m) {
  const SimConfig config = Sim();
  const SimScene scene(config);
  const float h = 1.0f / static_cast<float>(config.solver.substeps_per_s);
  Cloth cloth(MakeBagMesh(config.bag), config.bag, config.solver);
  cloth.SetState(scene.MakeStart(kind, kBenchSeed).cloth);
  std::vector<RigidShape> shapes;
  Eigen::Isometry3f X_WT = Eigen::Isometry3f::Identity();
  X_WT.linear() = Vec3f(1, -1, -1).asDiagonal();
  const auto step = [&] {
    cloth.Predict(h);
    cloth.SolveConstraints(h, X_WT, shapes);
  };
  if (radius_m > 0) {
    PadGap gap;
    X_WT.translation().x() = radius_m;
    gap.X_WT = X_WT;
    gap.opening_m = 0.03f;
    cloth.BeginHold(gap, 60);
    for (; X_WT.translation().z() < 0.15f; X_WT.translation().z() += 0.2f * h) step();
  }
  float angle = 0;
  for (auto _ : state) {
    if (radius_m > 0) {
      angle += 0.3f * h / radius_m;
      X_WT.translation() << radius_m * std::cos(angle), radius_m * std::sin(angle), 0.15f;
    }
    step();
  }
  if (cloth.holding() != (radius_m > 0)) state.SkipWithError("the hold is not as meant");
  state.counters["nodes"] = cloth.mesh().node_count();
  state.counters["substeps"] =
      benchmark::Counter(static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(ClothSubstep, flat, StartKind::kUnfolded, 0.0f);
BENCHMARK_CAPTURE(ClothSubstep, folded, StartKind::kFolded, 0.0f);
BENCHMARK_CAPTURE(ClothSubstep, folded_carried, StartKind::kFolded, 0.05f);

void Look(benchmark::State& state) { OverheadFrame(state, BagOne()); }
BENCHMARK(Look)->Name("OverheadFrame")->Unit(benchmark::kMillisecond);
void See(benchmark::State& state) { PerceiveFrame(state, BagOne()); }
BENCHMARK(See)->Name("PerceiveFrame")->Unit(benchmark::kMillisecond);

// Poses all over the table, each from the waiting pose.
void InverseKinematics(benchmark::State& state) {
  const ArmModel arm = ArmModel::Load(Sim().robot, AssetsFolder(), false);
  IkSolver ik(arm);
  int k = 0, unsolved = 0;
  for (auto _ : state) {
    const double x = 0.04 * (k % 7 - 3), y = 0.04 * (k / 7 % 7 - 3);
    const double yaw = 0.4 * (k % 5 - 2);
    const auto q = ik.Solve(DownwardPose({x, y, 0.1}, yaw), arm.waiting());
    unsolved += q ? 0 : 1;
    k = (k + 1) % 245;
  }
  state.counters["unsolved"] = unsolved;
}
BENCHMARK(InverseKinematics)->Unit(benchmark::kMicrosecond);

void SaveAndRestore(benchmark::State& state) {
  ReachingScene reaching(BagOne());
  Snapshot snapshot;
  for (auto _ : state) {
    snapshot = reaching.scene.Save();
    reaching.scene.Restore(snapshot, kBenchSeed);
  }
  state.counters["bytes"] = static_cast<double>(snapshot.size());
}
BENCHMARK(SaveAndRestore)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gusset

BENCHMARK_MAIN();
