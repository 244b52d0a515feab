#include "agents/evaluator.h"

#include <gmock/gmock.h>

#include "agents/pi_learning.h"
#include "agents/random_agent.h"
#include "agents/report/dumped_action.h"
#include "base/files.h"
#include "tests/agents/table_world.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

const auto kNeverStop = [] { return false; };

// An agent that knows: action s + 1 in state s (2 in s2, which has three actions).
class Expert final : public Agent {
 public:
  Decision Act(int state, std::span<const double>, int n, Mode, Rng&) const override {
    return {std::min(state + 1, n - 1), false, 0};
  }
  void Learn(const Transition&) override {}
  nlohmann::json Save() const override { return {}; }
  void Load(const nlohmann::json&) override {}
  std::string name() const override { return "expert"; }
};

EvaluationResult EvaluationOf(const Agent& agent, const EvaluationConfig& config, int jobs = 1) {
  Workers workers(jobs, [] { return std::make_unique<TableWorld>(); });
  return Evaluate(workers, agent, config, kNeverStop);
}

TEST(Evaluate, StoppedInTheMidstOfAnActionItSaysSo) {
  for (const int jobs : {1, 2}) {
    Workers workers(jobs, [] { return std::make_unique<TableWorld>(-1, 30); });
    try {
      Evaluate(workers, Expert(), {.episodes = 50}, StopRequested);
      ADD_FAILURE() << "not stopped";
    } catch (const RunError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr("interrupted after "));
    }
    ForgetStop();
  }
}

TEST(WilsonInterval, HasItsClosedForm) {
  // No success in n trials: [0, z^2 / (n + z^2)]; all of them: its mirror image.
  const double z2 = 1.959963984540054 * 1.959963984540054;
  const auto none = WilsonInterval(0, 10);
  EXPECT_NEAR(none[0], 0, 1e-15);
  EXPECT_NEAR(none[1], z2 / (10 + z2), 1e-15);
  const auto all = WilsonInterval(10, 10);
  EXPECT_NEAR(all[0], 1 - none[1], 1e-15);
  EXPECT_NEAR(all[1], 1, 1e-15);
  // Half of them: symmetric about 1/2 with half-width z / (2 sqrt(n + z^2)).
  const auto half = WilsonInterval(25, 50);
  EXPECT_NEAR(half[0] + half[1], 1, 1e-15);
  EXPECT_NEAR(half[1] - half[0], std::sqrt(z2 / (50 + z2)), 1e-15);
  // Both ends solve (p - rate)^2 = z^2 p (1 - p) / n, which defines the interval.
  for (const double p : WilsonInterval(7, 20)) {
    EXPECT_NEAR((p - 0.35) * (p - 0.35), z2 * p * (1 - p) / 20, 1e-15);
  }
  EXPECT_EQ(WilsonInterval(0, 0), (std::array<double, 2>{0, 1}));
}

TEST(Evaluator, TheExpertBeatsTheRandomPolicy) {
  const EvaluationConfig config{.episodes = 200};
  const EvaluationResult expert = EvaluationOf(Expert(), config);
  const EvaluationResult random = EvaluationOf(RandomAgent(), config);
  // Five tries at 0.9 in s0 to s2, one in s3, a tenth of the successes untrue: 0.9 by the camera,
  // 0.81 in truth. Bounds are more than three standard errors (0.03) off.
  EXPECT_GT(expert.perceived_successes, 200 * 0.8);
  EXPECT_LT(expert.true_successes, expert.perceived_successes);
  EXPECT_LT(random.perceived_successes, 200 * 0.4);
  EXPECT_EQ(expert.disagreements, expert.perceived_successes - expert.true_successes);
}

TEST(Evaluator, FramesAreKeptOfEveryActionOfAFailedEpisodeAndOfNoOther) {
  const TemporaryFolder folder;
  const std::filesystem::path& dir = folder.path();
  EvaluationConfig config{.episodes = 20};
  config.dump = "failures";
  config.frames = dir;
  const EvaluationResult result = EvaluationOf(Expert(), config, 2);
  ASSERT_GT(result.true_successes, 0);
  ASSERT_LT(result.true_successes, 20);
  std::size_t expected = 0;
  for (const Episode& episode : result.episodes) {
    if (!episode.true_success) expected += episode.steps.size();
  }
  const std::vector<DumpedAction> actions = ReadDumpedActions(dir);
  EXPECT_EQ(actions.size(), expected);
  for (const DumpedAction& action : actions) {
    EXPECT_EQ(action.episode_success, false);
    const Episode& episode = result.episodes.at(static_cast<std::size_t>(*action.episode));
    EXPECT_FALSE(episode.true_success);
    EXPECT_EQ(episode.steps.at(static_cast<std::size_t>(action.step)).action, action.action);
  }

  const std::string first = actions[0].prefix.filename();
  WriteFileAtomic(dir / (first + "_before.png"), "a picture");
  WriteFileAtomic(dir / (first + "_notes.txt"), "somebody's");
  WriteFileAtomic(dir / "episode.json", "{ somebody's");
  MakeFolder(dir / (first + "_before.png.d"));
  RemoveDumpedActions(dir, "action");
  RemoveDumpedActions(dir, "episode");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(dir), {}), 3) << "somebody's";
}

TEST(Evaluator, TalliesAddUp) {
  const EvaluationResult result = EvaluationOf(RandomAgent(), {.episodes = 100});
  std::array<int, 4> attempts{};
  for (const Episode& episode : result.episodes) {
    EXPECT_LE(episode.steps.size(), 20u);
    EXPECT_FALSE(episode.true_success && !episode.perceived_success);
    for (const Episode::Step& step : episode.steps)
      ++attempts[static_cast<std::size_t>(step.state)];
  }
  for (std::size_t s = 0; s < 4; ++s) {
    const StateTally& tally = result.per_step[s];
    EXPECT_EQ(tally.attempts, attempts[s]);
    EXPECT_LE(tally.successes, tally.attempts);
    EXPECT_LE(tally.passed, tally.reached);
    EXPECT_LE(tally.reached, 100);
  }
  EXPECT_EQ(result.per_step[3].successes, result.perceived_successes);
  EXPECT_EQ(result.per_step[0].reached, 100);
}

TEST(Evaluator, AnUnfoldedStartSkipsTheFirstState) {
  const EvaluationResult result =
      EvaluationOf(Expert(), {.start = StartKind::kUnfolded, .episodes = 30});
  for (const Episode& episode : result.episodes) {
    // The noise of TableWorld's looks may still show s0.
    EXPECT_LE(episode.steps.front().state, 1);
  }
  EXPECT_EQ(result.per_step[1].reached, 30);
}

TEST(Evaluator, NoStateIsTriedMoreOftenThanAllowed) {
  const EvaluationResult result = EvaluationOf(RandomAgent(), {.episodes = 100, .max_repeats = 2});
  for (const Episode& episode : result.episodes) {
    std::array<int, 4> tries{};
    for (const Episode::Step& step : episode.steps) {
      EXPECT_LE(++tries[static_cast<std::size_t>(step.state)], 2);
    }
  }
  const EvaluationResult brief = EvaluationOf(RandomAgent(), {.episodes = 100, .max_actions = 3});
  for (const Episode& episode : brief.episodes) EXPECT_LE(episode.steps.size(), 3u);
}

TEST(Evaluator, DependsOnTheSeedOnlyNotOnTheNumberOfWorkers) {
  const auto actions = [](const EvaluationResult& result) {
    std::vector<int> all;
    for (const Episode& e : result.episodes) {
      for (const Episode::Step& s : e.steps) all.push_back(s.action);
    }
    return all;
  };
  const EvaluationConfig config{.episodes = 40, .seed = 3};
  const EvaluationResult one = EvaluationOf(RandomAgent(), config);
  EXPECT_EQ(actions(one), actions(EvaluationOf(RandomAgent(), config, 4)));
  EXPECT_NE(actions(one), actions(EvaluationOf(RandomAgent(), {.episodes = 40, .seed = 4})));
}

TEST(Evaluator, StopsWhenAsked) {
  Workers workers(2, [] { return std::make_unique<TableWorld>(); });
  EXPECT_THROW((void)Evaluate(workers, Expert(), {}, [] { return true; }), RunError);
}

TEST(Workers, TheEarliestErrorIsTheOneReported) {
  for (const int jobs : {1, 3}) {
    Workers workers(jobs, [] { return std::make_unique<TableWorld>(); });
    std::vector<Workers::Task> tasks;
    for (int i = 0; i < 20; ++i) {
      tasks.push_back([i](Environment&) {
        if (i % 5 == 3) throw RunError(std::to_string(i));
      });
    }
    try {
      workers.Run(tasks);
      FAIL();
    } catch (const RunError& e) {
      EXPECT_STREQ(e.what(), "3");
    }
    int ran = 0;
    workers.Run({[&](Environment&) { ran = 1; }});
    EXPECT_EQ(ran, 1) << "workers must survive an error";
  }
}

}  // namespace
}  // namespace gusset
