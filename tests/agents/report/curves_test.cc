#include "agents/report/curves.h"

#include <gmock/gmock.h>

#include "agents/plots.h"

namespace gusset {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

RunData Trained(int seed, std::vector<double> rewards, const std::string& friction = "0.5") {
  RunData run;
  run.train.seed = seed;
  run.config = {{"train.agent", "pi"}, {"bag.friction", friction}};
  run.rewards[1] = std::move(rewards);
  return run;
}

TEST(RunningMean, IsTheMeanOfTheLastValues) {
  EXPECT_THAT(RunningMean({1, 2, 3, 4}, 2), ElementsAre(1, 1.5, 2.5, 3.5));
  EXPECT_THAT(RunningMean({1, 2, 3}, 100), ElementsAre(1, 1.5, 2));
  EXPECT_THAT(RunningMean({}, 3), ElementsAre());
}

TEST(BandOver, HasMeanLowestAndHighestOfTheSeriesThatAreLongEnough) {
  const Band band = BandOver({{1, 5, 9}, {3, 1}, {}});
  EXPECT_THAT(band.mean, ElementsAre(2, 3, 9));
  EXPECT_THAT(band.low, ElementsAre(1, 1, 9));
  EXPECT_THAT(band.high, ElementsAre(3, 5, 9));
  EXPECT_TRUE(BandOver({}).mean.empty());
}

TEST(GroupRuns, PutsSeedsTogetherAndSaysWhatTellsOtherRunsApart) {
  const std::vector<RunData> runs = {Trained(2, {0}), Trained(1, {0}, "0.3"), Trained(1, {1})};
  const std::vector<RunGroup> groups = GroupRuns(runs);
  ASSERT_EQ(groups.size(), 2u);
  EXPECT_THAT(groups[0].runs, ElementsAre(&runs[2], &runs[0])) << "by seed";
  EXPECT_THAT(groups[0].label, HasSubstr("bag.friction = 0.5"));
  EXPECT_THAT(groups[1].label, HasSubstr("bag.friction = 0.3"));
  EXPECT_EQ(GroupRuns({runs[0]})[0].label, "pi, bag1, 100 steps per state");
  const Band band = LearningCurve(groups[0], 1);
  EXPECT_THAT(band.mean, ElementsAre(0.5));
  EXPECT_TRUE(LearningCurve(groups[0], 0).mean.empty());
}

// Pooling the seeds and counting by hand are the same.
TEST(PooledEvaluations, AddUpOverSeedsButNotOverWhatWasMeasured) {
  std::vector<RunData> runs = {Trained(1, {}), Trained(2, {})};
  for (RunData& run : runs) {
    for (const char* start : {"folded", "unfolded"}) {
      EvaluationData one;
      one.start = start;
      one.episodes = 10;
      one.true_successes = run.train.seed;
      one.per_step[2] = {7, 3 * run.train.seed};
      run.evaluations.push_back(one);
    }
    EvaluationData other = run.evaluations[0];
    other.repeats = 1;
    run.evaluations.push_back(other);
    other.random = true;
    run.evaluations.push_back(other);
    other.overrides = "sensor.preset = \"clean\"";
    run.evaluations.push_back(other);
  }
  const std::vector<RunGroup> groups = GroupRuns(runs);
  const std::vector<EvaluationData> pooled = PooledEvaluations(groups.at(0));
  ASSERT_EQ(pooled.size(), 5u);
  for (const EvaluationData& one : pooled) {
    EXPECT_EQ(one.episodes, 20);
    EXPECT_EQ(one.true_successes, 3);
    EXPECT_EQ(one.per_step[2].attempts, 14);
    EXPECT_EQ(one.per_step[2].successes, 9);
  }
}

}  // namespace
}  // namespace gusset
