#include "agents/evaluator.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "agents/outcome_fields.h"
#include "base/error.h"
#include "base/random.h"
#include "base/stop.h"

namespace gusset {
namespace {

// Room for the seeds of one episode's actions.
constexpr std::uint64_t kSeedsPerEpisode = 1024;

// What is known of an episode's last action, with the keys of steps.jsonl.
nlohmann::ordered_json About(const Episode& episode, int index, int state, int action,
                             const Outcome& outcome) {
  nlohmann::ordered_json about = {
      {"episode", index}, {"step", episode.steps.size() - 1}, {"state", state}, {"action", action}};
  about.update(OutcomeFields(outcome));
  about["start_seed"] = episode.start_seed;
  about["sensor_seed"] = episode.steps.back().sensor_seed;
  return about;
}

}  // namespace

std::array<double, 2> WilsonInterval(int successes, int trials) {
  if (trials == 0) return {0, 1};
  constexpr double z = 1.959963984540054;  // 97.5 % point of the normal distribution
  const double n = trials;
  const double p = successes / n;
  const double centre = (p + z * z / (2 * n)) / (1 + z * z / n);
  const double half = z / (1 + z * z / n) * std::sqrt(p * (1 - p) / n + z * z / (4 * n * n));
  return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

Episode RunEpisode(Environment& environment, const Agent& agent, const EvaluationConfig& config,
                   int index, EpisodeFrames* frames) {
  const auto episode_index = static_cast<std::uint64_t>(index);
  Episode episode;
  episode.start_seed = DeriveSeed(config.seed, "evaluation start", episode_index);
  const std::vector<int> n_actions = environment.ActionCounts();
  std::vector<int> repeats(n_actions.size());

  Snapshot snapshot = environment.Start(config.start, episode.start_seed);
  for (int i = 0; i < config.max_actions; ++i) {
    const std::uint64_t seed_index =
        episode_index * kSeedsPerEpisode + static_cast<std::uint64_t>(i);
    const std::uint64_t sensor_seed = DeriveSeed(config.seed, "evaluation sensor", seed_index);
    const Percept percept = environment.Begin(snapshot, sensor_seed);
    const auto state = static_cast<std::size_t>(percept.state);
    // Another noise may show an end that the action before did not; there is nothing to do then.
    if (state >= n_actions.size() || repeats[state] == config.max_repeats) break;
    ++repeats[state];
    Rng rng(DeriveSeed(config.seed, "evaluation agent", seed_index));
    const Decision decision =
        agent.Act(percept.state, percept.features, n_actions[state], Mode::kGreedy, rng);
    Outcome outcome = environment.Act(decision.action);
    const bool advanced = Advanced(percept.state, outcome);
    episode.steps.push_back({percept.state, decision.action, outcome.next.state,
                             outcome.truth.state, advanced, sensor_seed});
    episode.sim_s += outcome.sim_s;
    episode.perceived_success = outcome.success;
    episode.true_success = outcome.true_success;
    if (frames) {
      frames->Add([&] { return environment.Frames(); },
                  About(episode, index, percept.state, decision.action, outcome));
    }
    if (outcome.done) break;
    snapshot = std::move(outcome.after);
  }
  return episode;
}

EvaluationResult Tally(std::vector<Episode> episodes) {
  EvaluationResult result;
  for (const Episode& episode : episodes) {
    result.true_successes += episode.true_success;
    result.perceived_successes += episode.perceived_success;
    result.disagreements += episode.true_success != episode.perceived_success;
    result.seconds_sim += episode.sim_s;
    std::array<bool, 4> reached{};
    std::array<bool, 4> passed{};
    for (const Episode::Step& step : episode.steps) {
      const auto s = static_cast<std::size_t>(step.state);
      StateTally& tally = result.per_step.at(s);
      ++tally.attempts;
      tally.successes += step.advanced;
      reached[s] = true;
      passed[s] = passed[s] || step.advanced;
      result.state_disagreements += step.next_state != step.true_state;
    }
    for (std::size_t s = 0; s < reached.size(); ++s) {
      result.per_step[s].reached += reached[s];
      result.per_step[s].passed += passed[s];
    }
  }
  result.episodes = std::move(episodes);
  return result;
}

EvaluationResult Evaluate(Workers& workers, const Agent& agent, const EvaluationConfig& config,
                          const std::function<bool()>& stop) {
  std::vector<Episode> episodes(static_cast<std::size_t>(config.episodes));
  std::vector<Workers::Task> tasks;
  std::atomic<int> done = 0;
  for (int i = 0; i < config.episodes; ++i) {
    tasks.push_back([&, i](Environment& environment) {
      const auto interrupted = [&] {
        return RunError("interrupted after " + std::to_string(done) + " episodes");
      };
      if (stop()) throw interrupted();
      Episode& episode = episodes[static_cast<std::size_t>(i)];
      EpisodeFrames frames(config.dump, config.frames / fmt::format("episode{:03}_action", i));
      try {
        episode = RunEpisode(environment, agent, config, i, &frames);
      } catch (const Interrupted&) {
        throw interrupted();
      }
      frames.Finish(episode.true_success);
      spdlog::info("episode {} of {}: {} actions, {}", ++done, config.episodes,
                   episode.steps.size(), episode.true_success ? "success" : "failure");
    });
  }
  workers.Run(tasks);
  return Tally(std::move(episodes));
}

}  // namespace gusset
