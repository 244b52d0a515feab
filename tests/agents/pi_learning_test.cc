#include "agents/pi_learning.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "agents/random_agent.h"
#include "base/error.h"

namespace gusset {
namespace {

PiLearning Learner(const std::string& update, int n_actions = 5, int steps = 100) {
  return PiLearning({.update = update, .steps_per_state = steps}, {n_actions});
}

void Teach(PiLearning& agent, int action, double reward) {
  agent.Learn({.state = 0, .action = action, .n_actions = 5, .reward = reward});
}

TEST(PiLearning, MeanIsTheMeanOfAllRewards) {
  PiLearning agent = Learner("mean");
  double sum = 0;
  for (int m = 1; m <= 50; ++m) {
    const double reward = std::sin(m);
    sum += reward;
    Teach(agent, 2, reward);
    EXPECT_NEAR(agent.value(0, 2), sum / m, 1e-14);  // a few roundings of numbers below 1
    EXPECT_EQ(agent.count(0, 2), m);
  }
}

// Eq. 5.9 as printed: Pi_m = (Pi_{m-1} + R) / m, so m Pi_m / R = 1 + Pi_{m-1} / R, and with
// Pi_{m-1} <= 2R / (m - 1) by induction the value falls to R/m.
TEST(PiLearning, PublishedDecaysToTheRewardOverTheCount) {
  PiLearning agent = Learner("published");
  constexpr double kReward = 0.8;
  double expected = 0;
  for (int m = 1; m <= 200; ++m) {
    Teach(agent, 1, kReward);
    expected = (expected + kReward) / m;
    EXPECT_DOUBLE_EQ(agent.value(0, 1), expected);
    if (m > 2) {
      EXPECT_GE(m * agent.value(0, 1) / kReward, 1);
      EXPECT_LE(m * agent.value(0, 1) / kReward, 1 + 2.0 / (m - 1) + 1e-12);  // rounding
    }
  }
}

TEST(PiLearning, LastIsTheLastReward) {
  PiLearning agent = Learner("last");
  for (const double reward : {0.3, 0.9, -0.1}) {
    Teach(agent, 4, reward);
    EXPECT_EQ(agent.value(0, 4), reward);
  }
}

TEST(PiLearning, EpsilonFallsLinearlyToItsFloor) {
  PiLearning agent = Learner("mean", 5, 100);
  for (int n = 0; n <= 150; ++n) {
    EXPECT_NEAR(agent.Epsilon(0), std::max(0.05, 0.05 + 0.95 * (1 - n / 100.0)), 1e-15);
    Teach(agent, 0, 0);
  }
}

TEST(PiLearning, EpsilonIsPerState) {
  PiLearning agent({.steps_per_state = 10}, {3, 3});
  for (int n = 0; n < 10; ++n) agent.Learn({.state = 1, .action = 0, .n_actions = 3});
  EXPECT_EQ(agent.Epsilon(0), 1);
  EXPECT_NEAR(agent.Epsilon(1), 0.05, 1e-15);
}

TEST(PiLearning, TiesAreRandomInTrainingAndTheLowestIndexInEvaluation) {
  PiLearning agent({.epsilon_min = 0, .steps_per_state = 1}, {5});
  Teach(agent, 0, -1);
  Teach(agent, 3, 0.5);
  Teach(agent, 1, 0.5);
  std::set<int> seen;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng(seed);
    const Decision decision = agent.Act(0, {}, 5, Mode::kExplore, rng);
    EXPECT_FALSE(decision.explored);
    seen.insert(decision.action);
    EXPECT_EQ(agent.Act(0, {}, 5, Mode::kGreedy, rng).action, 1);
  }
  EXPECT_THAT(seen, testing::ElementsAre(1, 3));
}

TEST(PiLearning, AnUntriedActionIsBetterThanAPunishedOne) {
  PiLearning agent = Learner("mean");
  Teach(agent, 0, -0.1);
  EXPECT_EQ(agent.best(0), 1);
}

// The identity task: in state s action s earns 1, any other 0.
class PiIdentity : public testing::TestWithParam<std::string> {};

TEST_P(PiIdentity, IsSolved) {
  constexpr int kStates = 4;
  constexpr int kSteps = 100;
  PiLearning agent({.update = GetParam(), .steps_per_state = kSteps}, {4, 4, 4, 4});
  for (int i = 0; i < kSteps * kStates; ++i) {
    Rng rng(DeriveSeed(1, "agent", static_cast<std::uint64_t>(i)));
    const int s = i % kStates;
    const Decision decision = agent.Act(s, {}, 4, Mode::kExplore, rng);
    agent.Learn({.state = s,
                 .action = decision.action,
                 .n_actions = 4,
                 .reward = decision.action == s ? 1.0 : 0.0});
  }
  for (int s = 0; s < kStates; ++s) EXPECT_EQ(agent.best(s), s);
}
INSTANTIATE_TEST_SUITE_P(Rules, PiIdentity, testing::Values("mean", "published", "last"));

TEST(PiLearning, LoadingWhatWasSavedChangesNothing) {
  PiLearning agent = Learner("mean");
  for (int i = 0; i < 37; ++i) Teach(agent, i % 4, std::sin(i) / 3);
  PiLearning loaded = Learner("published", 5, 7);
  // Through text, as on disk.
  loaded.Load(nlohmann::json::parse(agent.Save().dump()));
  EXPECT_EQ(loaded.Save(), agent.Save());
  for (int i = 0; i < 20; ++i) {
    Teach(agent, i % 5, std::cos(i));
    Teach(loaded, i % 5, std::cos(i));
  }
  EXPECT_EQ(loaded.Save().dump(), agent.Save().dump());
}

TEST(PiLearning, ADamagedPolicyIsRefusedAndChangesNothing) {
  PiLearning agent = Learner("mean");
  Teach(agent, 2, 0.5);
  const nlohmann::json good = agent.Save();
  const auto damaged = [&](const std::string& pointer, const nlohmann::json& value) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(pointer)] = value;
    return bad;
  };
  nlohmann::json twice = damaged("/states/0/steps", 2);
  twice["states"][0]["tried"].push_back(good["states"][0]["tried"][0]);
  for (const nlohmann::json& bad :
       {twice, damaged("/states/0/best", 1), nlohmann::json(), nlohmann::json::array(),
        nlohmann::json(3), damaged("/update", "best"), damaged("/update", 3),
        damaged("/steps_per_state", 0), damaged("/epsilon_min", 2),
        damaged("/states", nlohmann::json::array()), damaged("/states/0/n_actions", 6),
        damaged("/states/0/steps", -1), damaged("/states/0/tried/0/action", 5),
        damaged("/states/0/tried/0/action", -1), damaged("/states/0/tried/0/count", 0),
        damaged("/states/0/tried/0/value", nullptr), damaged("/states/0/tried/0/value", "high"),
        damaged("/states/0/tried", 7), damaged("/states", 7)}) {
    EXPECT_THROW(agent.Load(bad), InputError) << bad;
    EXPECT_EQ(agent.Save(), good);
  }
}

TEST(PiLearning, AnUnknownUpdateRuleIsRefused) {
  EXPECT_THROW(PiLearning({.update = "average"}, {3}), InputError);
}

TEST(RandomAgent, UsesEveryActionInBothModes) {
  const RandomAgent agent;
  for (const Mode mode : {Mode::kExplore, Mode::kGreedy}) {
    std::set<int> seen;
    Rng rng(1);
    for (int i = 0; i < 200; ++i) seen.insert(agent.Act(0, {}, 9, mode, rng).action);
    EXPECT_EQ(seen.size(), 9u);
  }
}

}  // namespace
}  // namespace gusset
