#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/gusset/settings.h"

namespace gusset {

/// What measurements go by.
struct BenchContext {
  const Settings& settings;
  std::vector<std::string>
      settings_arguments;  ///< The options that made them, for a child process.
  bool quick = false;      ///< Fewer repetitions, and no training.
};

/// What one measurement yields: figures by name, and what stands behind them.
struct Measured {
  nlohmann::ordered_json figures = nlohmann::ordered_json::object();
  nlohmann::ordered_json detail = nlohmann::ordered_json::object();
};

/// One measurement of one or more figures. Both sides of a ratio are measured in turns within it.
struct Measurement {
  std::vector<std::string> figures;
  Measured (*measure)(const BenchContext& context);
  bool in_quick = true;
};

/// All of them, in the order in which they should run: memory first, in a fresh process.
const std::vector<Measurement>& Measurements();

/// Runs those that `only` names (empty: all).
/// @returns one key per figure of the contract, null for what was not measured, and "detail".
nlohmann::ordered_json RunMeasurements(const BenchContext& context,
                                       const std::vector<std::string>& only);

// world_figures.cc: physics alone.
Measured MeasureAwake(const BenchContext& context);
Measured MeasureAgainstBtDeformable(const BenchContext& context);
Measured MeasureGrowth(const BenchContext& context);
// action_figures.cc: whole actions, training.
Measured MeasureActions(const BenchContext& context);
Measured MeasureTwoCores(const BenchContext& context);
Measured MeasureMemory(const BenchContext& context);
Measured MeasureTraining(const BenchContext& context);
// looks.cc.
Measured MeasureFrame(const BenchContext& context);
Measured MeasurePerception(const BenchContext& context);

/// Processor, cores, load, compiler, flags and versions.
nlohmann::ordered_json DescribeMachine();

}  // namespace gusset
