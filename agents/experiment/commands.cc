#include "agents/experiment/commands.h"

#include <algorithm>
#include <cctype>

namespace gusset {

std::string ShellWord(const std::string& word) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) ||
           std::string("_-./=+:,@%").find(c) != std::string::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, plain)) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

std::string TrainingFolder(const std::string& training, int seed) {
  return "trainings/" + training + "-seed" + std::to_string(seed);
}

std::string TrainCommandLine(const TrainingPlan& plan, int seed, const std::string& more) {
  std::string line = "gusset train --agent " + plan.agent + " --bag bag1 --steps " +
                     std::to_string(plan.steps) + " --seed " + std::to_string(seed);
  line += more;
  for (const std::string& setting : plan.settings) line += " --set " + ShellWord(setting);
  return line + " --out " + kRepeatFolder + "/" + plan.name + "-seed" + std::to_string(seed);
}

std::string EvaluateCommandLine(const TrainingPlan& training, const TrialPlan& plan,
                                const std::string& out, const std::string& more) {
  const CellPlan& cell = plan.cell;
  std::string line = "gusset evaluate --policy " +
                     ShellWord(out + "/" + TrainingFolder(cell.training, plan.seed)) + " --bag " +
                     cell.bag + " --start " + TrialName(plan.kind);
  if (cell.any_pose) line += " --pose any";
  if (cell.max_repeats != CellPlan().max_repeats) {
    line += " --repeats " + std::to_string(cell.max_repeats);
  }
  line += " --episodes " + std::to_string(plan.count) + " --seed " +
          std::to_string(plan.evaluation_seed()) + more;
  // The run's config.toml holds the training's settings, but `more` is read over it.
  if (more.empty()) return line;
  for (const std::string& setting : training.settings) line += " --set " + ShellWord(setting);
  return line;
}

std::string ExperimentCommandLine(const RowPlan& row, const ExperimentOptions& options,
                                  int first_seed, int seeds, const std::string& more) {
  const auto option = [](const char* name, int value) {
    return std::string(" --") + name + " " + std::to_string(value);
  };
  std::string line = "gusset experiment thesis --only " + row.table + " --agents " + row.training +
                     option("seed", first_seed) + option("seeds", seeds);
  if (!row.cell.empty()) {
    line += option("episodes", options.episodes) + option("attempts", options.attempts);
  }
  if (options.max_steps > 0) line += option("steps", options.max_steps);
  line += more + " --out " + kRepeatFolder + "/" + row.table + "-" + row.training;
  return seeds == 1 ? line + "-seed" + std::to_string(first_seed) : line;
}

}  // namespace gusset
