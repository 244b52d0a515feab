#pragma once

#include <string>
#include <vector>

namespace gusset {

/// What `gusset experiment thesis` is asked for.
struct ExperimentOptions {
  bool full = false;                     ///< Also the tables that the thesis does not have.
  std::vector<std::string> tables = {};  ///< Only these; empty: the thesis's, with `full` all.
  std::vector<std::string> agents = {};  ///< Only these trainings, by name; empty: all.
  int first_seed = 1;                    ///< Of training; the others follow it.
  int seeds = 5;
  int episodes = 20;  ///< From each start, per cell and seed.
  int attempts = 20;  ///< Per step, cell and seed.
  int max_steps = 0;  ///< Bound on every training's steps per state; 0: none.
};

/// One training, for every seed. Its name is that of its rows and, with the seed, of its folder.
struct TrainingPlan {
  std::string name;
  std::string agent = "pi";
  int steps = 100;                         ///< Learnt steps per state.
  std::vector<std::string> settings = {};  ///< section.key=value, over the defaults.
};

/// One way in which a training's policy is tried, for every seed.
struct CellPlan {
  std::string name;
  std::string training;  ///< TrainingPlan::name.
  std::string bag = "bag1";
  bool any_pose = false;
  int max_repeats = 5;   ///< EvaluationConfig::max_repeats.
  bool attempts = true;  ///< Steps are tried one by one too.
};

/// One row of a table: what a training was paid, how its policy does in a cell, or both.
struct RowPlan {
  std::string table;
  std::string row;
  std::string training;
  std::string cell = {};  ///< Empty: none.
};

/// The grid: trainings and cells that the rows asked for need, each once.
struct ExperimentPlan {
  std::vector<TrainingPlan> trainings;
  std::vector<CellPlan> cells;
  std::vector<RowPlan> rows;

  const TrainingPlan& training(const std::string& name) const;
  const CellPlan& cell(const std::string& name) const;
};

/// Names of all tables, the thesis's first.
const std::vector<std::string>& ExperimentTables();

/// True for a table that the thesis has.
bool IsThesisTable(const std::string& table);

/// The grid of sections 5.4 and 5.5 of the thesis (docs/experiments.md), as far as asked for.
/// @throws InputError naming what is asked for and not there, or out of bounds.
ExperimentPlan ThesisPlan(const ExperimentOptions& options);

}  // namespace gusset
