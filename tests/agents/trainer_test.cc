#include "agents/trainer.h"

#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <sstream>

#include "agents/pi_learning.h"
#include "agents/random_agent.h"
#include "base/files.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

using nlohmann::json;

PiLearning NewAgent(const TrainConfig& config) {
  return PiLearning({.steps_per_state = config.steps}, TableWorld().ActionCounts());
}

std::vector<json> Steps(const RunFolder& folder) {
  std::vector<json> steps;
  std::istringstream lines(ReadFile(folder.steps()));
  for (std::string line; std::getline(lines, line);) steps.push_back(json::parse(line));
  return steps;
}

// The log without wall times, the only thing in it that may differ.
std::string StepsWithoutClocks(const RunFolder& folder) {
  std::string text;
  for (json step : Steps(folder)) {
    step.erase("wall_s");
    text += step.dump() + "\n";
  }
  return text;
}

class TrainerTest : public FolderTest {
 protected:
  RunFolder NewFolder(const std::string& name) {
    return RunFolder::Create(dir_ / name, "", nlohmann::ordered_json::object());
  }
  // @returns the error that ended the run; "" if it ended well.
  std::string Run(
      const RunFolder& folder, const TrainConfig& config, int jobs = 1, int crash_at = -1,
      const std::function<bool()>& stop = [] { return false; }) {
    Workers workers(jobs, [&] { return std::make_unique<TableWorld>(crash_at); });
    PiLearning agent = NewAgent(config);
    try {
      summary_ = Train(workers, agent, config, folder, {{"bag", "none"}}, stop);
    } catch (const RunError& e) {
      return e.what();
    }
    return "";
  }
  // @returns why the folder is not gone on with.
  std::string Refusal(const RunFolder& folder, const TrainConfig& config) {
    try {
      return "not refused: " + Run(folder, config);
    } catch (const InputError& e) {
      return e.what();
    }
  }
  TrainSummary summary_;
};

// The action under way is given up, and that is no failure of the world.
TEST_F(TrainerTest, StoppedInTheMidstOfAnActionItCanBeResumed) {
  for (const char* protocol : {"pools", "chain"}) {
    const TrainConfig config{.protocol = protocol, .steps = 5};
    const RunFolder unbroken = NewFolder(std::string("unbroken_") + protocol);
    ASSERT_EQ(Run(unbroken, config), "");
    const RunFolder folder = NewFolder(protocol);
    Workers workers(1, [] { return std::make_unique<TableWorld>(-1, 4); });
    PiLearning agent = NewAgent(config);
    try {
      Train(workers, agent, config, folder, {{"bag", "none"}}, StopRequested);
      ADD_FAILURE() << "not stopped";
    } catch (const RunError& e) {
      EXPECT_THAT(e.what(),
                  testing::HasSubstr("interrupted after 4 actions; " + folder.root().string()));
    }
    ForgetStop();
    EXPECT_EQ(Steps(folder).size(), 4u);
    EXPECT_FALSE(Exists(folder.root() / "failed_step.json"));
    ASSERT_EQ(Run(folder, config), "");
    EXPECT_EQ(StepsWithoutClocks(folder), StepsWithoutClocks(unbroken));
  }
}

TEST_F(TrainerTest, EveryStateGetsItsStepsInOrder) {
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, {.steps = 30}), "");
  std::vector<int> order;
  std::map<int, int> count;
  int extra = 0;
  for (const json& step : Steps(folder)) {
    if (step["kind"] == "extra") {
      ++extra;
      EXPECT_FALSE(step["explored"]);
      continue;
    }
    order.push_back(step["state"]);
    ++count[step["state"]];
  }
  EXPECT_TRUE(std::ranges::is_sorted(order));
  EXPECT_THAT(count, testing::ElementsAre(testing::Pair(0, 30), testing::Pair(1, 30),
                                          testing::Pair(2, 30), testing::Pair(3, 30)));
  EXPECT_EQ(summary_.extra_actions, extra);
  EXPECT_EQ(summary_.actions, 120 + extra);
  EXPECT_DOUBLE_EQ(summary_.sim_s, 10.0 * summary_.actions);
}

TEST_F(TrainerTest, StepsStartWhereAnEarlierStepWasSeenToLeaveTheBag) {
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, {.steps = 30}), "");
  const std::vector<json> steps = Steps(folder);
  for (const json& step : steps) {
    if (step["state"] == 0) {
      EXPECT_EQ(step["from"]["start"], "folded");
    } else {
      const std::size_t id = step["from"]["step"];
      EXPECT_EQ(steps[id]["next_state"], step["state"]);
      EXPECT_LT(id, step["step"]);
    }
  }
}

TEST_F(TrainerTest, EveryBagOfAPoolIsTakenBeforeAnyIsTakenAgain) {
  const RunFolder folder = NewFolder("run");
  constexpr int kSteps = 30;
  ASSERT_EQ(Run(folder, {.steps = kSteps, .pool_min = 7}), "");
  std::map<int, int> left;  // how many bags a state's pool held when its training began
  std::map<int, std::map<int, int>> taken;
  for (const json& step : Steps(folder)) {
    if (step["kind"] == "train") ++taken[step["state"]][step["from"].value("step", 0)];
    const int next = step["next_state"];
    if (!step["done"] && !taken.contains(next)) ++left[next];
  }
  for (const int state : {1, 2, 3}) {
    // Noise shows a bag in another state now and then, and another is taken in its place. Draws
    // from the whole pool each time would leave out three in ten or more.
    const double all = std::min(left[state], kSteps);
    EXPECT_GE(static_cast<double>(taken[state].size()), 0.85 * all) << "s" << state;
  }
}

TEST_F(TrainerTest, APoolTooSmallIsFilledByTheGreedyPolicy) {
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, {.steps = 5, .pool_min = 20}), "");
  EXPECT_GT(summary_.extra_actions, 30);
  std::map<int, int> seen;
  bool third_began = false;
  for (const json& step : Steps(folder)) {
    third_began = third_began || (step["state"] == 2 && step["kind"] == "train");
    if (!third_began && !step["done"]) ++seen[step["next_state"]];
  }
  EXPECT_EQ(seen[2], 20);
}

TEST_F(TrainerTest, ARunThatNeverReachesAStateIsGivenUpWithAReason) {
  const RunFolder folder = NewFolder("run");
  const std::string error = Run(folder, {.steps = 1, .seed = 3, .max_extra_actions = 0});
  EXPECT_THAT(error, testing::HasSubstr("no bag has reached s"));
}

TEST_F(TrainerTest, LearnsTheBestActions) {
  const RunFolder folder = NewFolder("run");
  const TrainConfig config{.steps = 100};
  ASSERT_EQ(Run(folder, config), "");
  PiLearning agent = NewAgent(config);
  LoadPolicy(folder.policy(), agent);
  for (int s = 0; s < 4; ++s) EXPECT_EQ(agent.best(s), s == 2 ? 2 : s + 1) << s;
}

TEST_F(TrainerTest, TheSameSeedGivesTheSameBitsWhateverTheNumberOfWorkers) {
  const TrainConfig config{.steps = 25, .seed = 5};
  const RunFolder one = NewFolder("one");
  ASSERT_EQ(Run(one, config), "");
  for (const int jobs : {1, 2, 3, 7}) {
    const RunFolder other = NewFolder("other" + std::to_string(jobs));
    ASSERT_EQ(Run(other, config, jobs), "");
    EXPECT_EQ(ReadFile(one.policy()), ReadFile(other.policy())) << jobs;
    EXPECT_EQ(StepsWithoutClocks(one), StepsWithoutClocks(other)) << jobs;
  }
  const RunFolder different = NewFolder("different");
  ASSERT_EQ(Run(different, {.steps = 25, .seed = 6}), "");
  EXPECT_NE(ReadFile(one.policy()), ReadFile(different.policy()));
}

class TrainerResume : public TrainerTest, public testing::WithParamInterface<std::string> {};

// Killed again and again, each time at another action, and with what a kill can leave behind: lines
// that no checkpoint knows of, half a line, half a file.
TEST_P(TrainerResume, AKilledRunEndsLikeAnUnbrokenOne) {
  const TrainConfig config{.protocol = GetParam(), .steps = 20, .seed = 9};
  const RunFolder unbroken = NewFolder("unbroken");
  ASSERT_EQ(Run(unbroken, config), "");

  const RunFolder killed = NewFolder("killed");
  int runs = 0;
  for (int lives = 1; !Run(killed, config, 1 + lives % 2, lives).empty(); lives += 3) {
    std::ofstream(killed.steps(), std::ios::app) << "{\"step\":999}\n{\"ste";
    std::ofstream(killed.root() / "checkpoint" / "state.json.tmp") << "{\"pro";
    ASSERT_LT(++runs, 1000);
  }
  EXPECT_GT(runs, 5);
  EXPECT_EQ(ReadFile(unbroken.policy()), ReadFile(killed.policy()));
  EXPECT_EQ(StepsWithoutClocks(unbroken), StepsWithoutClocks(killed));
}
INSTANTIATE_TEST_SUITE_P(Protocols, TrainerResume, testing::Values("pools", "chain"));

TEST_F(TrainerTest, AFinishedRunResumedStaysTheSame) {
  const TrainConfig config{.steps = 5};
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, config), "");
  const std::string policy = ReadFile(folder.policy());
  const std::string steps = ReadFile(folder.steps());
  ASSERT_EQ(Run(RunFolder::Open(folder.root()), config), "");
  EXPECT_EQ(ReadFile(folder.policy()), policy);
  EXPECT_EQ(ReadFile(folder.steps()), steps);
}

TEST_F(TrainerTest, AStopEndsBetweenActionsWithAWordOnHowToGoOn) {
  const RunFolder folder = NewFolder("run");
  int asked = 0;
  const std::string error = Run(folder, {.steps = 20}, 1, -1, [&] { return ++asked > 10; });
  EXPECT_THAT(error, testing::AllOf(testing::HasSubstr("--resume"),
                                    testing::Not(testing::HasSubstr("\n"))));
  EXPECT_FALSE(std::filesystem::exists(folder.policy()));
  EXPECT_TRUE(std::filesystem::exists(folder.root() / "checkpoint" / "state.json"));
}

TEST_F(TrainerTest, AFailedActionLeavesWhatIsNeededToSeeItAgain) {
  const RunFolder folder = NewFolder("run");
  const std::string error = Run(folder, {.steps = 20}, 1, 7);
  EXPECT_THAT(error, testing::HasSubstr("the world came apart"));
  EXPECT_THAT(error, testing::HasSubstr("--step 7"));
  const json failed = ReadJson(folder.root() / "failed_step.json");
  EXPECT_EQ(failed["step"], 7);
  EXPECT_TRUE(failed["from"].contains("seed"));
}

TEST_F(TrainerTest, ChainLearnsInEveryStateAndIsGreedyWhereItIsFull) {
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, {.protocol = "chain", .steps = 10}), "");
  std::map<int, int> count;
  const std::vector<json> steps = Steps(folder);
  for (const json& step : steps) {
    if (step["kind"] == "train") {
      ++count[step["state"]];
    } else {
      EXPECT_EQ(count[step["state"]], 10);
      EXPECT_FALSE(step["explored"]);
    }
    if (step["from"].contains("step")) {
      EXPECT_EQ(step["from"]["step"], static_cast<int>(step["step"]) - 1);
    }
  }
  for (int s = 0; s < 4; ++s) EXPECT_EQ(count[s], 10);
}

// Remembers whether each transition followed on from the one before.
class Follower final : public Agent {
 public:
  Decision Act(int, std::span<const double>, int n, Mode, Rng& rng) const override {
    return {rng.Below(n), true, 1};
  }
  void Learn(const Transition& transition) override { follows.push_back(transition.follows); }
  nlohmann::json Save() const override { return {}; }
  void Load(const nlohmann::json&) override {}
  std::string name() const override { return "follower"; }
  std::vector<bool> follows;
};

TEST_F(TrainerTest, ATransitionFollowsIfItBeganWhereTheOneLearntBeforeItEnded) {
  for (const char* protocol : {"pools", "chain"}) {
    const RunFolder folder = NewFolder(protocol);
    Workers workers(1, [] { return std::make_unique<TableWorld>(); });
    Follower agent;
    Train(workers, agent, {.protocol = protocol, .steps = 20}, folder, {}, [] { return false; });
    std::size_t learnt = 0;
    int last = -1, number_that_follow = 0;
    for (const json& step : Steps(folder)) {
      if (step["kind"] != "train") continue;
      const bool wanted = last >= 0 && step["from"].value("step", -1) == last;
      ASSERT_EQ(agent.follows[learnt], wanted) << learnt;
      number_that_follow += wanted;
      last = step["step"];
      ++learnt;
    }
    EXPECT_EQ(learnt, agent.follows.size());
    EXPECT_TRUE(protocol == std::string("pools") || number_that_follow > 20);
  }
}

TEST_F(TrainerTest, FramesAreKeptOnlyForWhatWasAskedFor) {
  const auto frames = [](const RunFolder& folder) {
    return std::distance(std::filesystem::directory_iterator(folder.frames()), {});
  };
  const RunFolder all = NewFolder("all");
  ASSERT_EQ(Run(all, {.steps = 5, .pool_min = 4, .dump = "all"}, 2), "");
  EXPECT_EQ(frames(all), summary_.actions);
  const RunFolder failures = NewFolder("failures");
  ASSERT_EQ(Run(failures, {.steps = 5, .pool_min = 4, .dump = "failures"}, 3), "");
  EXPECT_EQ(StepsWithoutClocks(failures), StepsWithoutClocks(all)) << "looking on changes nothing";
  // Failed: no later state followed, as seen, or the camera was wrong about what did.
  int failed = 0;
  for (const json& step : Steps(failures)) {
    const bool advanced = step["next_state"] > step["state"] && step["next_state"] != 5;
    const bool wrong =
        step["next_state"] != step["next_state_true"] || step["success"] != step["success_true"];
    const std::string name = "step" + step["step"].dump() + ".json";
    EXPECT_EQ(std::filesystem::exists(failures.frames() / name), !advanced || wrong) << step;
    failed += !advanced || wrong;
  }
  EXPECT_GT(failed, 0);
  EXPECT_LT(failed, summary_.actions);
  EXPECT_EQ(frames(failures), failed);
  const RunFolder none = NewFolder("none");
  ASSERT_EQ(Run(none, {.steps = 5, .pool_min = 4}, 2), "");
  EXPECT_EQ(frames(none), 0);
}

// A try whose turn comes too late is made anew, and leaves nothing of itself.
TEST_F(TrainerTest, FramesAreTheSameWhateverTheNumberOfWorkers) {
  std::map<std::string, std::string> of_one;
  for (const int jobs : {1, 7}) {
    const RunFolder folder = NewFolder("jobs" + std::to_string(jobs));
    ASSERT_EQ(Run(folder, {.steps = 60, .seed = 3, .dump = "failures"}, jobs), "");
    std::map<std::string, std::string> frames;
    for (const auto& entry : std::filesystem::directory_iterator(folder.frames())) {
      json about = ReadJson(entry.path());
      about.erase("wall_s");
      frames[entry.path().filename()] = about.dump();
    }
    ASSERT_GT(frames.size(), 20u);
    if (jobs == 1) of_one = frames;
    EXPECT_EQ(frames, of_one) << jobs;
  }
}

TEST_F(TrainerTest, FramesThatCannotBeWrittenStopTheRunBetweenActionsAndItGoesOn) {
  const RunFolder unbroken = NewFolder("unbroken");
  ASSERT_EQ(Run(unbroken, {.steps = 5, .pool_min = 4}), "");
  const RunFolder folder = NewFolder("run");
  // A folder where the fourth action's file should go.
  std::filesystem::create_directory(folder.frames() / "step3.json");
  const std::string error = Run(folder, {.steps = 5, .pool_min = 4, .dump = "all"}, 2);
  EXPECT_THAT(error, testing::HasSubstr("step3.json: cannot replace"));
  EXPECT_EQ(Steps(folder).size(), 3u) << "what was done before is kept";
  EXPECT_FALSE(std::filesystem::exists(folder.root() / "failed_step.json"));
  std::filesystem::remove(folder.frames() / "step3.json");
  ASSERT_EQ(Run(folder, {.steps = 5, .pool_min = 4, .dump = "all"}, 2), "");
  EXPECT_EQ(StepsWithoutClocks(folder), StepsWithoutClocks(unbroken));
}

TEST_F(TrainerTest, AFolderThatHoldsARunIsNotOverwritten) {
  const RunFolder folder = NewFolder("run");
  EXPECT_THROW(NewFolder("run"), InputError);
  EXPECT_THROW((void)RunFolder::Open(dir_ / "nothing"), InputError);
}

TEST_F(TrainerTest, ABrokenCheckpointIsRefusedInOneLine) {
  const TrainConfig config{.steps = 5};
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, config), "");
  for (const char* broken : {"", "{", "[]", "{\"progress\":{},\"agent\":{}}", "null"}) {
    WriteFileAtomic(folder.root() / "checkpoint" / "state.json", broken);
    try {
      Run(folder, config);
      ADD_FAILURE() << broken;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr("state.json: "));
      EXPECT_THAT(e.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }
}

TEST_F(TrainerTest, ALostCheckpointDoesNotCostTheLog) {
  const RunFolder folder = NewFolder("run");
  ASSERT_NE(Run(folder, {.steps = 20}, 1, 7), "");
  const std::string steps = ReadFile(folder.steps()), curve = ReadFile(folder.progress());
  std::filesystem::remove(folder.root() / "checkpoint" / "state.json");
  EXPECT_THAT(Refusal(folder, {.steps = 20}), testing::HasSubstr("state.json: is missing"));
  EXPECT_EQ(ReadFile(folder.steps()), steps);
  EXPECT_EQ(ReadFile(folder.progress()), curve);
}

// Each of these once crashed, or cut the log before it was refused.
TEST_F(TrainerTest, ACheckpointWithImpossibleNumbersIsRefusedAndCostsNothing) {
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, {.steps = 5}), "");
  const std::filesystem::path file = folder.root() / "checkpoint" / "state.json";
  const std::string steps = ReadFile(folder.steps());
  const json good = ReadJson(file);
  const auto refused = [&](const char* key, const json& value, const char* why) {
    json bad = good;
    bad["progress"][json::json_pointer(key)] = value;
    WriteFileAtomic(file, bad.dump());
    EXPECT_THAT(Refusal(folder, {.steps = 5}), testing::HasSubstr(why)) << key << " " << value;
    EXPECT_EQ(ReadFile(folder.steps()), steps);
  };
  refused("/frozen_size/3", 100000000, "frozen_size[3] = 100000000 is not within [1, ");
  refused("/frozen_size/3", 0, "frozen_size[3] = 0 is not within [1, ");
  refused("/learnt/0", -5, "learnt[0] = -5 is not within [0, ");
  refused("/source_size/2", 100000000, "source_size[2]");
  refused("/pools/1/0", -1, "pools[1] = -1");
  refused("/actions", 4294967377, "actions = 4294967377 has the wrong type or size");
  refused("/learnt/0", 1e30, "learnt[0] = 1e+30 has the wrong type or size");
  refused("/sim_s", -5, "sim_s is below 0");
  refused("/steps_bytes", 5, "steps.jsonl: has 0 lines in the 5 bytes");
  refused("/steps_bytes", 0, "steps.jsonl: has 0 lines in the 0 bytes");
  refused("/progress_bytes", 0, "progress.csv: has 0 lines in the 0 bytes");
  WriteFileAtomic(file, good.dump());
  EXPECT_EQ(Run(folder, {.steps = 5}), "");
}

TEST_F(TrainerTest, TheCurveFileHasOneLinePerAction) {
  const RunFolder folder = NewFolder("run");
  ASSERT_EQ(Run(folder, {.steps = 5}), "");
  const std::string text = ReadFile(folder.progress());
  EXPECT_EQ(std::ranges::count(text, '\n'), summary_.actions + 1);
  EXPECT_THAT(text, testing::StartsWith("global_step,state,"));
}

}  // namespace
}  // namespace gusset
