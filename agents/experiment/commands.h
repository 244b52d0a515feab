#pragma once

#include <string>

#include "agents/experiment/plan.h"
#include "agents/experiment/trial.h"

namespace gusset {

/// Where repeated trainings and experiments go, beside what they repeat.
inline constexpr const char* kRepeatFolder = "out/again";

/// A word as a POSIX shell reads it back, in quotes only where it needs them.
std::string ShellWord(const std::string& word);

/// Folder of a training within an experiment's: "trainings/pi100-seed1".
std::string TrainingFolder(const std::string& training, int seed);

/// The command that repeats a training.
/// @param more  further arguments, as --config and --set, with a space before each; may be empty.
std::string TrainCommandLine(const TrainingPlan& plan, int seed, const std::string& more);

/// The command that repeats a trial of whole episodes with the policy under `out`.
std::string EvaluateCommandLine(const TrainingPlan& training, const TrialPlan& plan,
                                const std::string& out, const std::string& more);

/// The command that repeats the rows of a table that come from one training, for some seeds.
std::string ExperimentCommandLine(const RowPlan& row, const ExperimentOptions& options,
                                  int first_seed, int seeds, const std::string& more);

}  // namespace gusset
