#pragma once

#include <benchmark/benchmark.h>

#include "sim/sim_scene.h"
#include "tools/gusset/settings.h"

namespace gusset {

/// The world's sections of settings that were read with LoadSettings.
SimConfig SimConfigOf(const Settings& settings);

/// Seed of starts: a bag folded along two or three lines, a bag laid flat.
inline constexpr std::uint64_t kBenchSeed = 2;

/// The scene with an unfolded bag and the arm's hand over it.
struct ReachingScene {
  /// @throws RunError if the hand does not get there.
  explicit ReachingScene(const Settings& settings);
  SimScene scene;
};

/// Google Benchmarks of one look at that scene.
/// Colour and depth, with sensor noise.
void OverheadFrame(benchmark::State& state, const Settings& settings);
/// State, areas and pose points from that frame.
void PerceiveFrame(benchmark::State& state, const Settings& settings);

}  // namespace gusset
