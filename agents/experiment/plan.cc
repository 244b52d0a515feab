#include "agents/experiment/plan.h"

#include <algorithm>

#include "base/error.h"

namespace gusset {
namespace {

constexpr const char* kChain = "train.protocol=chain";
constexpr const char* kNoAffordances = "train.affordances=false";
constexpr const char* kEarly = "dqn.learning_starts=50";

// Every training there is. Networks get the thesis's 400 steps, 100 per state.
std::vector<TrainingPlan> AllTrainings() {
  std::vector<TrainingPlan> all;
  const std::vector<int> thesis_steps = {100, 50, 30, 10};
  for (const int n : thesis_steps) all.push_back({"pi" + std::to_string(n), "pi", n});
  all.push_back({"dqn", "dqn"});
  // Stable-Baselines 2 starts learning after 1,000 steps, which 400 never reach.
  all.push_back({"dqn_ls50", "dqn", 100, {kEarly}});
  all.push_back({"a2c", "a2c"});
  for (const int n : thesis_steps) {
    for (const std::string rule : {"published", "last"}) {
      all.push_back({"pi" + std::to_string(n) + "_" + rule, "pi", n, {"pi.update=" + rule}});
    }
  }
  all.push_back({"random", "random"});
  all.push_back({"q_learning", "q_learning"});
  // Without affordances a greedy policy may pick a pair that does not fit, again and again, and
  // never fill a pool; so chains, and a chain with affordances to compare with.
  all.push_back({"q_learning_chain", "q_learning", 100, {kChain}});
  all.push_back({"q_learning_no_affordances", "q_learning", 100, {kChain, kNoAffordances}});
  for (const std::string kind : {"plain", "double", "dueling"}) {
    all.push_back({kind + "_dqn_ls50", kind + "_dqn", 100, {kEarly}});
  }
  for (const std::string agent : {"ppo", "ucb1", "thompson"}) all.push_back({agent, agent});
  all.push_back({"pi100_chain", "pi", 100, {kChain}});
  all.push_back({"pi100_no_affordances", "pi", 100, {kChain, kNoAffordances}});
  for (const std::string mm : {"0", "1", "2", "3"}) {
    all.push_back({"pi100_depth" + mm + "mm", "pi", 100, {"sensor.depth_sigma_mm=" + mm}});
  }
  return all;
}

struct Tables {
  ExperimentPlan plan;

  void Row(const std::string& table, const std::string& training) {
    plan.rows.push_back({table, training, training});
  }
  // A row whose policy is tried as well. Cells that rows share are made once.
  void Tried(const std::string& table, const std::string& row, CellPlan cell) {
    plan.rows.push_back({table, row, cell.training, cell.name});
    const auto same = [&](const CellPlan& other) { return other.name == cell.name; };
    if (std::ranges::none_of(plan.cells, same)) plan.cells.push_back(std::move(cell));
  }
  void Tried(const std::string& table, const std::string& training) {
    Tried(table, training, {training, training});
  }
};

// All rows of all tables, and the cells they need.
ExperimentPlan WholePlan() {
  Tables t;
  t.plan.trainings = AllTrainings();
  const std::vector<std::string> thesis = {"pi100", "pi50",     "pi30", "pi10",
                                           "dqn",   "dqn_ls50", "a2c"};
  for (const char* table : {"5.4", "5.5"}) {
    for (const std::string& name : thesis) t.Row(table, name);
  }
  for (const std::string& name : thesis) t.Tried("5.6", name);
  t.Tried("5.7", "bag1", {"pi100", "pi100"});
  t.Tried("5.7", "bag2", {"pi100-bag2", "pi100", "bag2"});
  t.Tried("5.7", "bag3", {"pi100-bag3", "pi100", "bag3"});
  t.Tried("5.7", "any_pose", {"pi100-any_pose", "pi100", "bag1", true});
  for (const std::string& name : thesis) t.Row("fig5.6", name);

  for (const std::string pi : {"pi100", "pi50", "pi30", "pi10"}) {
    for (const std::string rule : {"", "_published", "_last"}) t.Tried("updates", pi + rule);
  }
  for (const char* name : {"pi100", "pi100_chain", "dqn_ls50", "plain_dqn_ls50", "double_dqn_ls50",
                           "dueling_dqn_ls50", "a2c", "ppo", "ucb1", "thompson", "q_learning",
                           "q_learning_chain", "q_learning_no_affordances", "random"}) {
    t.Tried("baselines", name);
  }
  for (const char* name : {"pi100", "pi100_chain", "pi100_no_affordances", "pi100_depth0mm",
                           "pi100_depth1mm", "pi100_depth2mm", "pi100_depth3mm"}) {
    t.Tried("ablations", name);
  }
  // A single action is not touched by how often it may be repeated.
  t.Tried("ablations", "pi100_repeats1", {"pi100-repeats1", "pi100", "bag1", false, 1, false});
  return t.plan;
}

bool Holds(const std::vector<std::string>& list, const std::string& name) {
  return std::ranges::find(list, name) != list.end();
}

void RefuseUnknown(const std::string& option, const std::vector<std::string>& asked,
                   const std::vector<std::string>& known) {
  for (const std::string& name : asked) {
    if (Holds(known, name)) continue;
    std::string list;
    for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
    throw InputError(option + ": there is no " + name + "; there are: " + list);
  }
}

void CheckBounds(const std::string& option, int value, int lo, int hi) {
  if (value >= lo && value <= hi) return;
  throw InputError(option + " = " + std::to_string(value) + " is not within [" +
                   std::to_string(lo) + ", " + std::to_string(hi) + "]");
}

template <class T>
const T& Named(const std::vector<T>& all, const std::string& name) {
  return *std::ranges::find_if(all, [&](const T& one) { return one.name == name; });
}

}  // namespace

const TrainingPlan& ExperimentPlan::training(const std::string& name) const {
  return Named(trainings, name);
}

const CellPlan& ExperimentPlan::cell(const std::string& name) const { return Named(cells, name); }

const std::vector<std::string>& ExperimentTables() {
  static const std::vector<std::string> tables = {"5.4",    "5.5",     "5.6",       "5.7",
                                                  "fig5.6", "updates", "baselines", "ablations"};
  return tables;
}

bool IsThesisTable(const std::string& table) {
  return table.starts_with("5.") || table.starts_with("fig");
}

ExperimentPlan ThesisPlan(const ExperimentOptions& options) {
  RefuseUnknown("--only", options.tables, ExperimentTables());
  CheckBounds("--seed", options.first_seed, 0, 1000000000);
  CheckBounds("--seeds", options.seeds, 1, 1000);
  CheckBounds("--episodes", options.episodes, 1, 10000);
  CheckBounds("--attempts", options.attempts, 1, 10000);
  CheckBounds("--steps", options.max_steps, 0, 1000000);

  ExperimentPlan plan = WholePlan();
  std::vector<std::string> names;
  std::erase_if(plan.rows, [&](const RowPlan& row) {
    if (!options.tables.empty()) return !Holds(options.tables, row.table);
    return !options.full && !IsThesisTable(row.table);
  });
  for (const TrainingPlan& training : plan.trainings) {
    const auto needs = [&](const RowPlan& row) { return row.training == training.name; };
    if (std::ranges::any_of(plan.rows, needs)) names.push_back(training.name);
  }
  RefuseUnknown("--agents", options.agents, names);
  if (!options.agents.empty()) {
    std::erase_if(plan.rows,
                  [&](const RowPlan& row) { return !Holds(options.agents, row.training); });
  }
  std::erase_if(plan.trainings, [&](const TrainingPlan& training) {
    return std::ranges::none_of(plan.rows,
                                [&](const RowPlan& row) { return row.training == training.name; });
  });
  std::erase_if(plan.cells, [&](const CellPlan& cell) {
    return std::ranges::none_of(plan.rows,
                                [&](const RowPlan& row) { return row.cell == cell.name; });
  });
  if (options.max_steps > 0) {
    for (TrainingPlan& training : plan.trainings) {
      training.steps = std::min(training.steps, options.max_steps);
    }
  }
  return plan;
}

}  // namespace gusset
