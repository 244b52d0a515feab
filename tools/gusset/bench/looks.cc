#include "tools/gusset/bench/looks.h"

#include "base/error.h"
#include "perception/perceive.h"
#include "sim/robot/tool_pose.h"
#include "tools/gusset/bench/suite.h"
#include "tools/gusset/bench/timing.h"

namespace gusset {

SimConfig SimConfigOf(const Settings& settings) {
  ConfigTree tree = settings.tree;
  SimConfig config;
  config.Read(tree);
  return config;
}

ReachingScene::ReachingScene(const Settings& settings) : scene(SimConfigOf(settings)) {
  scene.Reset(StartKind::kUnfolded, kBenchSeed);
  const MoveResult result = scene.robot().MoveTo(DownwardPose({0.05, 0.0, 0.15}, 0), 0.4);
  if (result.end != MoveEnd::kReached) throw RunError("bench: the hand is not over the bag");
}

void OverheadFrame(benchmark::State& state, const Settings& settings) {
  ReachingScene reaching(settings);
  reaching.scene.Look();  // the first one compiles Mesa's shaders
  for (auto _ : state) benchmark::DoNotOptimize(reaching.scene.Look());
}

void PerceiveFrame(benchmark::State& state, const Settings& settings) {
  ReachingScene reaching(settings);
  const RgbdFrame frame = reaching.scene.Look();
  const BaggingConfig& config = settings.bagging;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        Perceive(frame, reaching.scene.model(), config.perception, config.chosen_thresholds()));
  }
}

Measured MeasureFrame(const BenchContext& context) {
  Measured measured;
  measured.figures["frame_ms"] = GoogleBenchmarkMs(
      "frame_ms", [&](benchmark::State& state) { OverheadFrame(state, context.settings); },
      context.quick ? 3 : 5);
  return measured;
}

Measured MeasurePerception(const BenchContext& context) {
  Measured measured;
  measured.figures["perception_ms"] = GoogleBenchmarkMs(
      "perception_ms", [&](benchmark::State& state) { PerceiveFrame(state, context.settings); },
      context.quick ? 3 : 5);
  return measured;
}

}  // namespace gusset
