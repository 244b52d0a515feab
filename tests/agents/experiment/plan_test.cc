#include "agents/experiment/plan.h"

#include <gmock/gmock.h>

#include <set>

#include "agents/experiment/runner.h"
#include "agents/trainer.h"
#include "base/error.h"

namespace gusset {
namespace {

using testing::HasSubstr;

std::vector<std::string> Names(const ExperimentPlan& plan) {
  std::vector<std::string> names;
  for (const TrainingPlan& training : plan.trainings) names.push_back(training.name);
  return names;
}

int RowsOf(const ExperimentPlan& plan, const std::string& table) {
  return static_cast<int>(
      std::ranges::count_if(plan.rows, [&](const RowPlan& row) { return row.table == table; }));
}

TEST(ThesisPlan, IsTheThesissGrid) {
  const ExperimentPlan plan = ThesisPlan({});
  EXPECT_THAT(Names(plan),
              testing::ElementsAre("pi100", "pi50", "pi30", "pi10", "dqn", "dqn_ls50", "a2c"));
  for (const char* table : {"5.4", "5.5", "5.6", "fig5.6"}) EXPECT_EQ(RowsOf(plan, table), 7);
  EXPECT_EQ(RowsOf(plan, "5.7"), 4);
  EXPECT_EQ(plan.rows.size(), 32u);
  // Table 5.7's Bag 1 is the cell of Table 5.6's first row.
  EXPECT_EQ(plan.cells.size(), 7u + 3u);
  EXPECT_EQ(plan.training("pi30").steps, 30);
  EXPECT_EQ(plan.cell("pi100-bag3").bag, "bag3");
  EXPECT_TRUE(plan.cell("pi100-any_pose").any_pose);
}

// The number of learnt steps is the thesis's; trials add one action for each attempt at least.
TEST(ThesisPlan, TakesSomeTwentyFiveThousandActions) {
  const double learnt = 5 * 4 * (100 + 50 + 30 + 10 + 3 * 100);
  const double attempts = 5 * 10 * 4 * 20;
  const double expected = ExpectedActions(ThesisPlan({}), {});
  EXPECT_GT(expected, learnt + attempts);
  EXPECT_NEAR(expected, 25000, 2500);
}

TEST(ThesisPlan, FullHoldsTheThesissGridAndMore) {
  const ExperimentPlan thesis = ThesisPlan({});
  const ExperimentPlan full = ThesisPlan({.full = true});
  for (const std::string& name : Names(thesis)) EXPECT_THAT(Names(full), testing::Contains(name));
  EXPECT_EQ(RowsOf(full, "updates"), 12);  // four numbers of steps, three rules
  EXPECT_GT(RowsOf(full, "baselines"), 10);
  EXPECT_GT(RowsOf(full, "ablations"), 7);
  std::set<std::string> agents;
  for (const TrainingPlan& training : full.trainings) agents.insert(training.agent);
  EXPECT_THAT(agents, testing::UnorderedElementsAreArray(AgentNames()));
}

TEST(ThesisPlan, NamesAreUniqueAndEveryRowHasWhatItNeeds) {
  const ExperimentPlan plan = ThesisPlan({.full = true});
  std::set<std::string> trainings, cells;
  for (const TrainingPlan& one : plan.trainings) EXPECT_TRUE(trainings.insert(one.name).second);
  for (const CellPlan& one : plan.cells) {
    EXPECT_TRUE(cells.insert(one.name).second);
    EXPECT_TRUE(trainings.contains(one.training)) << one.name;
  }
  for (const RowPlan& row : plan.rows) {
    EXPECT_TRUE(trainings.contains(row.training)) << row.row;
    if (row.cell.empty()) continue;
    EXPECT_TRUE(cells.contains(row.cell)) << row.row;
    EXPECT_EQ(plan.cell(row.cell).training, row.training);
  }
}

TEST(ThesisPlan, AnyPartCanBeHadAlone) {
  const ExperimentPlan rewards = ThesisPlan({.tables = {"5.4"}});
  EXPECT_EQ(rewards.trainings.size(), 7u);
  EXPECT_TRUE(rewards.cells.empty());

  const ExperimentPlan transfer = ThesisPlan({.tables = {"5.7"}});
  EXPECT_THAT(Names(transfer), testing::ElementsAre("pi100"));
  EXPECT_EQ(transfer.cells.size(), 4u);

  const ExperimentPlan one = ThesisPlan({.tables = {"5.6"}, .agents = {"a2c"}});
  EXPECT_EQ(one.rows.size(), 1u);
  EXPECT_EQ(one.cells.size(), 1u);

  // Without --full too, if it is asked for by name.
  EXPECT_EQ(RowsOf(ThesisPlan({.tables = {"ablations"}}), "ablations"), 8);
}

TEST(ThesisPlan, ABoundOnStepsShortensTheLongTrainingsOnly) {
  const ExperimentPlan plan = ThesisPlan({.max_steps = 30});
  EXPECT_EQ(plan.training("pi100").steps, 30);
  EXPECT_EQ(plan.training("pi10").steps, 10);
}

TEST(ThesisPlan, WhatIsNotThereIsRefusedWithWhatIs) {
  const auto error = [](const ExperimentOptions& options) -> std::string {
    try {
      (void)ThesisPlan(options);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(error({.tables = {"5.3"}}), HasSubstr("there is no 5.3; there are: 5.4, 5.5"));
  EXPECT_THAT(error({.agents = {"pi20"}}), HasSubstr("--agents: there is no pi20"));
  // It is there, but not in the tables asked for.
  EXPECT_THAT(error({.tables = {"5.7"}, .agents = {"dqn"}}), HasSubstr("there are: pi100"));
  EXPECT_THAT(error({.seeds = 0}), HasSubstr("--seeds = 0 is not within [1, "));
  EXPECT_THAT(error({.episodes = 0}), HasSubstr("--episodes"));
  EXPECT_THAT(error({.attempts = -1}), HasSubstr("--attempts"));
  EXPECT_THAT(error({.max_steps = -1}), HasSubstr("--steps"));
}

}  // namespace
}  // namespace gusset
