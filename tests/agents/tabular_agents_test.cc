// What Q-learning, UCB1 and Thompson sampling must do on problems with known answers.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <set>

#include "agents/q_learning.h"
#include "agents/thompson_sampling.h"
#include "agents/ucb1.h"
#include "base/error.h"
#include "tests/agents/known_problems.h"

namespace gusset {
namespace {

std::unique_ptr<Agent> Make(const std::string& name, const std::vector<int>& n_actions,
                            int steps_per_state = 100) {
  if (name == "q_learning") {
    return std::make_unique<QLearning>(QLearningConfig{.steps_per_state = steps_per_state},
                                       n_actions);
  }
  if (name == "ucb1") return std::make_unique<Ucb1>(Ucb1Config{}, n_actions);
  return std::make_unique<ThompsonSampling>(n_actions);
}

class Tabular : public testing::TestWithParam<std::string> {};

TEST_P(Tabular, SolvesTheIdentityTask) {
  const std::unique_ptr<Agent> agent = Make(GetParam(), {4, 4, 4, 4});
  PlayIdentity(*agent, 4, 400, 1);
  for (int s = 0; s < 4; ++s) EXPECT_EQ(GreedyAction(*agent, s, 4), s);
}

TEST_P(Tabular, ContinuedFromAFileEqualsUninterrupted) {
  ExpectContinuedEqualsUninterrupted([] { return Make(GetParam(), {4, 4, 4, 4}); }, 60);
}

TEST_P(Tabular, ADamagedPolicyIsRefusedAndChangesNothing) {
  const std::unique_ptr<Agent> agent = Make(GetParam(), {4, 4, 4, 4});
  PlayIdentity(*agent, 4, 40, 1);
  const nlohmann::json good = agent->Save();
  const auto damaged = [&](const std::string& pointer, const nlohmann::json& value) {
    nlohmann::json bad = good;
    bad[nlohmann::json::json_pointer(pointer)] = value;
    return bad;
  };
  for (const nlohmann::json& bad :
       {nlohmann::json(), nlohmann::json(3), damaged("/states", 7),
        damaged("/states", nlohmann::json::array()), damaged("/states/0/n_actions", 5),
        damaged("/states/0/steps", 99), damaged("/states/0/tried/0/action", 4),
        damaged("/states/0/tried/0/value", nullptr)}) {
    EXPECT_THROW(agent->Load(bad), InputError) << bad;
    EXPECT_EQ(agent->Save(), good);
  }
}
INSTANTIATE_TEST_SUITE_P(Learners, Tabular, testing::Values("q_learning", "ucb1", "thompson"));

// ---- Q-learning

TEST(QLearning, ConvergesToTheChainsKnownValues) {
  QLearning agent({.alpha = 0.5, .gamma = Chain::kGamma, .epsilon_min = 1}, Chain::ActionCounts());
  Chain::Play(agent, 2000);
  for (int s = 0; s < Chain::kStates; ++s) {
    for (int a = 0; a < 2; ++a) {
      // Every pair is learnt some 200 times; the error at least halves each time after the next
      // state's is gone.
      EXPECT_NEAR(agent.value(s, a), Chain::BestValue(s, a), 1e-6) << s << a;
    }
  }
}

TEST(QLearning, OneStepIsTheWrittenFormula) {
  QLearning agent({.alpha = 0.25, .gamma = 0.5}, {2, 2});
  agent.Learn({.state = 1, .action = 1, .n_actions = 2, .reward = 0.8, .next_state = 2});
  EXPECT_DOUBLE_EQ(agent.value(1, 1), 0.25 * 0.8);  // s2 does not act
  agent.Learn({.state = 0, .action = 0, .n_actions = 2, .reward = 0.4, .next_state = 1});
  EXPECT_DOUBLE_EQ(agent.value(0, 0), 0.25 * (0.4 + 0.5 * 0.2));
  agent.Learn(
      {.state = 0, .action = 1, .n_actions = 2, .reward = 0.4, .next_state = 1, .done = true});
  EXPECT_DOUBLE_EQ(agent.value(0, 1), 0.25 * 0.4);
}

// ---- bandits

TEST(Ucb1, TriesEveryActionOnceFirst) {
  Ucb1 agent({}, {7});
  std::set<int> tried;
  for (std::uint64_t i = 0; i < 7; ++i) {
    Rng rng(i);
    const int action = agent.Act(0, {}, 7, Mode::kExplore, rng).action;
    tried.insert(action);
    agent.Learn({.state = 0, .action = action, .n_actions = 7, .reward = 1});
  }
  EXPECT_EQ(tried.size(), 7u);
}

TEST(Ucb1, TheIndexIsTheWrittenFormulaOnRewardsBetweenZeroAndOne) {
  Ucb1 agent({}, {2});
  for (const double reward : {-0.1, 1.0, 0.45}) {
    agent.Learn({.state = 0, .action = 0, .n_actions = 2, .reward = reward});
  }
  agent.Learn({.state = 0, .action = 1, .n_actions = 2, .reward = 1.04});  // cut off at 1
  EXPECT_NEAR(agent.Index(0, 0), 0.5 + std::sqrt(2 * std::log(4.0) / 3), 1e-15);
  EXPECT_NEAR(agent.Index(0, 1), 1 + std::sqrt(2 * std::log(4.0)), 1e-15);
}

// Auer et al. 2002, theorem 1: a worse arm is expected to be tried at most
// 8 ln n / gap^2 + 1 + pi^2 / 3 times; and ever better arms cannot be told apart with fewer than
// some tries (a bound from below: more than once per arm).
TEST(Ucb1, WorseArmsAreTriedAsRarelyAsTheTheoremSays) {
  constexpr int kSteps = 3000;
  constexpr double kGap = 0.5;  // on [0, 1]: 0.55 of reward
  double tries = 0;
  for (std::uint64_t run = 0; run < 10; ++run) {
    Ucb1 agent({}, {2});
    for (int i = 0; i < kSteps; ++i) {
      Rng rng(DeriveSeed(run, "test", static_cast<std::uint64_t>(i)));
      const int action = agent.Act(0, {}, 2, Mode::kExplore, rng).action;
      const double p = action == 0 ? 0.25 + kGap : 0.25;
      agent.Learn(
          {.state = 0, .action = action, .n_actions = 2, .reward = rng.Uniform() < p ? 1.0 : -0.1});
    }
    tries += agent.count(0, 1) / 10.0;
  }
  constexpr double kPi = 3.141592653589793;
  EXPECT_LT(tries, 8 * std::log(kSteps) / (kGap * kGap) + 1 + kPi * kPi / 3);
  EXPECT_GT(tries, 1);
}

// Mean a / (a + b), variance a b / ((a + b)^2 (a + b + 1)).
TEST(ThompsonSampling, TheBetaDrawsHaveTheirMoments) {
  for (const auto& [a, b] : {std::pair{1.0, 1.0}, {1.5, 1.5}, {8.0, 2.5}, {1.0, 90.0}}) {
    Rng rng(5);
    constexpr int kDraws = 100000;
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < kDraws; ++i) {
      const double x = DrawBeta(a, b, rng);
      ASSERT_GE(x, 0);
      ASSERT_LE(x, 1);
      sum += x;
      squares += x * x;
    }
    const double mean = sum / kDraws;
    const double variance = a * b / ((a + b) * (a + b) * (a + b + 1));
    EXPECT_NEAR(mean, a / (a + b), 5 * std::sqrt(variance / kDraws));
    EXPECT_NEAR(squares / kDraws - mean * mean, variance, 0.03 * variance);  // five sigma or more
  }
}

// Two routes to one distribution: Beta(k, n + 1 - k) is that of the k-th smallest of n uniforms.
TEST(ThompsonSampling, TheBetaDrawsAreThoseOfOrderStatistics) {
  constexpr int kDraws = 20000;
  Rng rng(6);
  std::vector<double> drawn, ordered;
  for (int i = 0; i < kDraws; ++i) {
    drawn.push_back(DrawBeta(3, 4, rng));
    std::array<double, 6> uniforms;
    for (double& u : uniforms) u = rng.Uniform();
    std::ranges::sort(uniforms);
    ordered.push_back(uniforms[2]);
  }
  std::ranges::sort(drawn);
  std::ranges::sort(ordered);
  double distance = 0;  // Kolmogorov and Smirnov's
  for (int i = 0, j = 0; i < kDraws && j < kDraws;) {
    drawn[static_cast<std::size_t>(i)] < ordered[static_cast<std::size_t>(j)] ? ++i : ++j;
    distance = std::max(distance, std::abs(i - j) / static_cast<double>(kDraws));
  }
  EXPECT_LT(distance, 1.95 * std::sqrt(2.0 / kDraws));  // exceeded once in a thousand times
}

TEST(ThompsonSampling, SettlesOnTheBetterArm) {
  ThompsonSampling agent({3});
  for (int i = 0; i < 1000; ++i) {
    Rng rng(DeriveSeed(3, "test", static_cast<std::uint64_t>(i)));
    const int action = agent.Act(0, {}, 3, Mode::kExplore, rng).action;
    const double p = action == 1 ? 0.7 : 0.3;
    agent.Learn(
        {.state = 0, .action = action, .n_actions = 3, .reward = rng.Uniform() < p ? 1.0 : -0.1});
  }
  EXPECT_EQ(agent.best(0), 1);
  EXPECT_GT(agent.count(0, 1), 850);
  EXPECT_GT(agent.count(0, 0) + agent.count(0, 2), 4);
}

}  // namespace
}  // namespace gusset
