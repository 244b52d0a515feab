#include "agents/experiment/attempts.h"

#include <gmock/gmock.h>

#include "agents/affordances.h"
#include "agents/random_agent.h"
#include "base/error.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

const auto kNever = [] { return false; };

// Takes TableWorld's best action, or always the worst.
class Fixed final : public Agent {
 public:
  explicit Fixed(bool best) : best_(best) {}
  Decision Act(int state, std::span<const double>, int n, Mode mode, Rng&) const override {
    EXPECT_EQ(mode, Mode::kGreedy);
    return {best_ ? std::min(state + 1, n - 1) : 0};
  }
  void Learn(const Transition&) override { ADD_FAILURE() << "attempts are not learnt from"; }
  nlohmann::json Save() const override { return {}; }
  void Load(const nlohmann::json&) override {}
  std::string name() const override { return "fixed"; }

 private:
  bool best_;
};

// A step's rate is that of its action: 0.9 for the best, 0.2 for another (tests/.../table_world.h).
// 400 attempts: four standard errors are 0.06 and 0.08.
TEST(Attempts, AStepsRateIsThatOfItsAction) {
  TableWorld world;
  for (const bool best : {true, false}) {
    const Fixed agent(best);
    const AttemptResult result = AttemptSteps(world, agent, {.attempts = 400}, kNever);
    for (const StepAttempts& step : result.steps) {
      EXPECT_EQ(step.attempts, 400);
      EXPECT_NEAR(step.seen_successes / 400.0, best ? 0.9 : 0.2, best ? 0.06 : 0.08);
      EXPECT_NEAR(step.reward / 400, best ? 1 : 0.3, 0.02);
    }
    // Of carries that look well nine in ten are.
    EXPECT_LT(result.steps[3].true_successes, result.steps[3].seen_successes);
    EXPECT_DOUBLE_EQ(result.sim_s, 10.0 * result.actions);
  }
}

TEST(Attempts, AGoodPolicyIsTriedOnItsOwnBagsABadOneOnOthersToo) {
  TableWorld world;
  const AttemptResult good = AttemptSteps(world, Fixed(true), {.attempts = 50}, kNever);
  const AttemptResult bad = AttemptSteps(world, Fixed(false), {.attempts = 50}, kNever);
  for (std::size_t s = 1; s < 4; ++s) {
    EXPECT_EQ(good.steps[s].own_bags, 50) << s;
    EXPECT_LT(bad.steps[s].own_bags, 50) << s;
    EXPECT_GT(bad.steps[s].own_bags, 10) << s;
  }
  EXPECT_GT(good.actions, 4 * 50);
  EXPECT_LT(good.actions, 5 * 50);
  EXPECT_LT(bad.actions, 4 * 50 + 3 * 2 * 50 + 2 * 4 * 50 + 1);
}

TEST(Attempts, TheSameSeedGivesTheSameResultInAnotherWorld) {
  TableWorld one, other;
  (void)other.Start(StartKind::kFolded, 1);
  const AttemptResult a = AttemptSteps(one, RandomAgent(), {.attempts = 20, .seed = 3}, kNever);
  const AttemptResult b = AttemptSteps(other, RandomAgent(), {.attempts = 20, .seed = 3}, kNever);
  const AttemptResult c = AttemptSteps(one, RandomAgent(), {.attempts = 20, .seed = 4}, kNever);
  bool differs = false;
  for (std::size_t s = 0; s < 4; ++s) {
    EXPECT_EQ(a.steps[s].reward, b.steps[s].reward);
    differs = differs || a.steps[s].reward != c.steps[s].reward;
  }
  EXPECT_EQ(a.actions, b.actions);
  EXPECT_TRUE(differs);
}

// No bag ever gets beyond step 2, however often it is tried.
class Stuck final : public Environment {
 public:
  std::vector<int> ActionCounts() const override { return {252, 252, 252, 252}; }
  Snapshot Start(StartKind kind, std::uint64_t) override {
    return kind == StartKind::kFolded ? "0" : "1";
  }
  Percept Begin(const Snapshot& snapshot, std::uint64_t) override {
    state_ = std::stoi(snapshot);
    return {state_};
  }
  Outcome Act(int action) override {
    EXPECT_TRUE(state_ == 0 ? action == 1 : action == 2 || (action >= 81 && action < 162));
    ++acts;
    Outcome outcome;
    outcome.next.state = outcome.truth.state = state_;
    outcome.after = std::to_string(state_);
    return outcome;
  }
  FrameWriter Frames() const override { return {}; }
  int acts = 0;

 private:
  int state_ = 0;
};

TEST(Attempts, AStepThatNoBagReachesIsNotTriedAndSaysSo) {
  Stuck world;
  const AttemptResult result = AttemptSteps(world, Fixed(true), {.attempts = 10}, kNever);
  EXPECT_EQ(result.steps[0].attempts, 10);
  EXPECT_EQ(result.steps[0].true_successes, 0);
  EXPECT_EQ(result.steps[1].attempts, 10);  // on bags laid out flat
  EXPECT_EQ(result.steps[1].own_bags, 0);
  EXPECT_EQ(result.steps[2].attempts, 0);
  EXPECT_EQ(result.steps[3].attempts, 0);
  // Step 1 and its fillers, step 2 and its greedy and random fillers.
  EXPECT_EQ(result.actions, 10 + 20 + 10 + 20 + 40);
  EXPECT_EQ(world.acts, result.actions);
}

TEST(Attempts, AStopEndsThem) {
  TableWorld world;
  int asked = 0;
  EXPECT_THROW(AttemptSteps(world, Fixed(true), {.attempts = 10}, [&] { return ++asked > 5; }),
               RunError);
}

}  // namespace
}  // namespace gusset
