#include "agents/replay.h"

#include <gmock/gmock.h>

#include "agents/pi_learning.h"
#include "agents/plots.h"
#include "agents/trainer.h"
#include "base/files.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

class Replay : public FolderTest, public testing::WithParamInterface<std::string> {
 protected:
  void Train(const std::string& protocol) {
    const TrainConfig config{.protocol = protocol, .steps = 8};
    Workers workers(2, [] { return std::make_unique<TableWorld>(); });
    PiLearning agent({.steps_per_state = config.steps}, TableWorld().ActionCounts());
    const RunFolder folder = RunFolder::Create(dir_ / "run", "", nlohmann::ordered_json::object());
    gusset::Train(workers, agent, config, folder, {}, [] { return false; });
  }
};

// A logged action done again has the logged outcome, whatever was done before it.
TEST_P(Replay, EveryLoggedActionComesOutAgain) {
  Train(GetParam());
  const std::vector<nlohmann::json> steps = ReadRunSteps(dir_ / "run");
  ASSERT_GT(steps.size(), 32u);
  TableWorld world;
  for (int i = static_cast<int>(steps.size()) - 1; i >= 0; --i) {
    const nlohmann::json& line = steps[static_cast<std::size_t>(i)];
    const Snapshot before = WorldBefore(world, steps, i);
    EXPECT_EQ(world.Begin(before, line["sensor_seed"]).state, line["state"]);
    const Outcome outcome = world.Act(line["action"]);
    EXPECT_EQ(outcome.reward, line["reward"]);
    EXPECT_EQ(outcome.next.state, line["next_state"]);
  }
  EXPECT_THROW(WorldBefore(world, steps, -1), InputError);
  EXPECT_THROW(WorldBefore(world, steps, static_cast<int>(steps.size())), InputError);
}
INSTANTIATE_TEST_SUITE_P(Protocols, Replay, testing::Values("pools", "chain"));

TEST_F(Replay, ADamagedLogIsRefusedWithItsLine) {
  Train("pools");
  const std::string log = ReadFile(dir_ / "run" / "steps.jsonl");
  const std::size_t second = log.find('\n') + 1;
  WriteFileAtomic(dir_ / "run" / "steps.jsonl", log.substr(0, second) + "{\"step\": 1, \"sta\n");
  try {
    (void)ReadRunSteps(dir_ / "run");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("steps.jsonl:2: "));
  }
  std::string line = log.substr(0, second);
  const std::size_t seed = line.find("\"sensor_seed\"");
  ASSERT_NE(seed, std::string::npos);
  line.replace(seed, 13, "\"sensor_speed\"");
  WriteFileAtomic(dir_ / "run" / "steps.jsonl", line);
  try {
    (void)ReadRunSteps(dir_ / "run");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("steps.jsonl:1: sensor_seed is missing"));
  }
  WriteFileAtomic(dir_ / "run" / "steps.jsonl", log.substr(0, second) + "{\"step\": 1, \"sta\n");
  EXPECT_THROW((void)ReadLoggedSteps(dir_ / "run" / "steps.jsonl"), InputError);
}

TEST_F(Replay, ALearningCurveShowsTheRewardsOfLearntStepsAlone) {
  Train("pools");
  std::vector<LoggedStep> steps = ReadLoggedSteps(dir_ / "run" / "steps.jsonl");
  const cv::Mat curve = DrawLearningCurve(steps, 4);
  EXPECT_EQ(curve.size(), cv::Size(800, 500));
  const auto differs = [&] {
    return cv::norm(curve, DrawLearningCurve(steps, 4), cv::NORM_INF) > 0;
  };
  const auto first = [&](bool learnt) {
    return std::find_if(steps.begin(), steps.end(),
                        [&](const LoggedStep& step) { return step.learnt == learnt; });
  };
  ASSERT_NE(first(false), steps.end());
  first(false)->reward += 5;
  EXPECT_FALSE(differs());
  first(true)->reward += 5;
  EXPECT_TRUE(differs());
  EXPECT_FALSE(DrawLearningCurve({}, 4).empty()) << "an empty run has a picture too";
}

TEST(Plots, MeanRewardsLeaveOutExtraActionsAndUntriedPoints) {
  const std::vector<LoggedStep> steps = {{0, 2, 0.5, true},
                                         {0, 2, 1.0, true},
                                         {0, 2, 9.0, false},
                                         {1, 2, 9.0, true},
                                         {0, 0, -1, true}};
  const std::vector<double> means = MeanRewards(steps, 0, 3);
  EXPECT_EQ(means[0], -1);
  EXPECT_TRUE(std::isnan(means[1]));
  EXPECT_EQ(means[2], 0.75);
}

}  // namespace
}  // namespace gusset
