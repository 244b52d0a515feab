#include "agents/experiment/attempts.h"

#include <utility>
#include <vector>

#include "agents/affordances.h"
#include "base/error.h"
#include "base/random.h"

namespace gusset {
namespace {

// How often another bag is taken because noise shows the last one in another state.
constexpr int kLooks = 64;
constexpr int kGreedyFillers = 2;  // per attempt
constexpr int kRandomFillers = 4;

// Any action of the pair that fits the state, also where all 252 are on offer.
int DrawFitting(int state, int n_actions, Rng& rng) {
  if (n_actions != AllActions()) return rng.Below(n_actions);
  int first = 0;
  for (int s = 0; s < state; ++s) first += AffordanceOf(s).actions();
  return first + rng.Below(AffordanceOf(state).actions());
}

class Attempts {
 public:
  Attempts(Environment& environment, const Agent& agent, const AttemptConfig& config,
           const std::function<bool()>& stop)
      : environment_(environment),
        agent_(agent),
        config_(config),
        stop_(stop),
        n_actions_(environment.ActionCounts()) {}

  AttemptResult Run() {
    for (int s = 0; s < kActingStates; ++s) {
      if (s > 0) Fill(s);
      StepAttempts& step = result_.steps[At(s)];
      step.own_bags = s > 0 ? own_bags_ : config_.attempts;
      for (int i = 0; i < config_.attempts && Find(s); ++i) {
        const Outcome outcome = Act(s, Greedy(s));
        ++step.attempts;
        step.reward += outcome.reward;
        step.seen_successes += Advanced(s, outcome, outcome.next.state, outcome.success);
        step.true_successes += Advanced(s, outcome, outcome.truth.state, outcome.true_success);
      }
    }
    return result_;
  }

 private:
  static std::size_t At(int state) { return static_cast<std::size_t>(state); }

  // Carrying must end with the task done, any other step in a later state of it.
  static bool Advanced(int s, const Outcome& outcome, int next_state, bool success) {
    if (s == kActingStates - 1) return success;
    return !outcome.done && next_state > s && next_state < kActingStates;
  }

  // Brings bags into s until there is one for every attempt, as far as that goes.
  void Fill(int s) {
    const auto missing = [&] { return std::ssize(pools_[At(s)]) < config_.attempts; };
    for (int i = 0; i < kGreedyFillers * config_.attempts && missing() && Find(s - 1); ++i) {
      Act(s - 1, Greedy(s - 1));
    }
    own_bags_ = std::min(static_cast<int>(pools_[At(s)].size()), config_.attempts);
    if (s == 1) {
      for (int i = 0; missing(); ++i) {
        pools_[At(s)].push_back(environment_.Start(config_.unfolded, Seed("attempt unfolded", i)));
      }
    }
    for (int i = 0; i < kRandomFillers * config_.attempts && missing() && Find(s - 1); ++i) {
      Rng rng(Seed("attempt filler", looks_));
      Act(s - 1, DrawFitting(s - 1, n_actions_[At(s - 1)], rng));
    }
  }

  // Begins with the next bag that the camera sees in s. @returns false if there is none.
  bool Find(int s) {
    const std::vector<Snapshot>& pool = pools_[At(s)];
    if (s > 0 && pool.empty()) return false;
    for (int i = 0; i < kLooks; ++i) {
      if (stop_()) {
        throw RunError("interrupted after " + std::to_string(result_.actions) + " actions");
      }
      const int bag = next_bag_[At(s)]++;
      ++looks_;
      percept_ =
          environment_.Begin(s == 0 ? environment_.Start(config_.folded, Seed("attempt start", bag))
                                    : pool[static_cast<std::size_t>(bag) % pool.size()],
                             Seed("attempt sensor", looks_));
      if (percept_.state == s) return true;
    }
    return false;
  }

  int Greedy(int s) {
    Rng rng(Seed("attempt agent", looks_));
    return agent_.Act(s, percept_.features, n_actions_[At(s)], Mode::kGreedy, rng).action;
  }

  // Performs an action on the bag found, and keeps what it leaves for the steps after it.
  Outcome Act(int s, int action) {
    Outcome outcome = environment_.Act(action);
    ++result_.actions;
    result_.sim_s += outcome.sim_s;
    const int next = outcome.next.state;
    if (!outcome.done && next > s && next < kActingStates) {
      pools_[At(next)].push_back(std::move(outcome.after));
    }
    return outcome;
  }

  std::uint64_t Seed(const char* purpose, int index) const {
    return DeriveSeed(config_.seed, purpose, static_cast<std::uint64_t>(index));
  }

  Environment& environment_;
  const Agent& agent_;
  const AttemptConfig& config_;
  const std::function<bool()>& stop_;
  std::vector<int> n_actions_;
  std::array<std::vector<Snapshot>, kActingStates> pools_;
  std::array<int, kActingStates> next_bag_{};
  int looks_ = 0;
  int own_bags_ = 0;
  Percept percept_;
  AttemptResult result_;
};

}  // namespace

AttemptResult AttemptSteps(Environment& environment, const Agent& agent,
                           const AttemptConfig& config, const std::function<bool()>& stop) {
  return Attempts(environment, agent, config, stop).Run();
}

}  // namespace gusset
