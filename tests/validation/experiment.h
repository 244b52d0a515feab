#pragma once

#include <memory>
#include <string>
#include <vector>

#include "agents/bagging_env.h"
#include "sim/sim_scene.h"
#include "tools/gusset/command.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/sim_referee.h"

namespace gusset {

/// The bagging task on the simulated rig, with the world in sight: for measuring it.
struct Rig {
  explicit Rig(const Settings& from);

  Settings settings;
  SimScene scene;
  SimReferee referee;
  BaggingEnv env;
};

/// Mean and standard deviation of what was added, and how sure the mean is.
class Readings {
 public:
  void Add(double value) { values_.push_back(value); }
  int count() const { return static_cast<int>(values_.size()); }
  double mean() const;
  double deviation() const;  ///< Of the sample; 0 for fewer than two values.
  double error() const;      ///< Standard error of the mean.

 private:
  std::vector<double> values_;
};

/// "| a | b |" of cells that were printed as in printf.
std::string Row(const std::vector<std::string>& cells);
std::string Number(double value, const char* format = "%.4g");

/// @param command  the exact command line, printed with the results.
std::unique_ptr<Command> MakeCrossingsExperiment(std::string command);
std::unique_ptr<Command> MakeGraspExperiment(std::string command);
std::unique_ptr<Command> MakeRefinementExperiment(std::string command);
std::unique_ptr<Command> MakePairsExperiment(std::string command);

}  // namespace gusset
