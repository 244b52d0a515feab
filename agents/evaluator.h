#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/frame_dump.h"
#include "agents/workers.h"

namespace gusset {

/// How a policy is judged.
struct EvaluationConfig {
  StartKind start = StartKind::kFolded;
  int episodes = 50;
  std::uint64_t seed = 7;
  int max_repeats = 5;                ///< Actions in one state before the episode is given up.
  int max_actions = 20;               ///< Of an episode.
  std::string dump = "none";          ///< Of which episodes frames are kept (agents/frame_dump.h).
  std::filesystem::path frames = {};  ///< A folder that exists, for them.
};

/// One episode.
struct Episode {
  struct Step {
    int state = 0;
    int action = 0;
    int next_state = 0;  ///< As the camera saw it.
    int true_state = 0;
    bool advanced = false;  ///< A later state of the task followed, as the camera saw it.
    std::uint64_t sensor_seed = 0;
  };
  std::uint64_t start_seed = 0;
  std::vector<Step> steps;
  bool perceived_success = false;
  bool true_success = false;
  double sim_s = 0;
};

/// Interval that holds a binomial's rate with 95 % confidence, by Wilson's score (Wilson 1927).
/// @returns {0, 1} for no trials.
std::array<double, 2> WilsonInterval(int successes, int trials);

/// How one state's actions went.
struct StateTally {
  int attempts = 0;   ///< Actions.
  int successes = 0;  ///< Those that led to a later state, as the camera saw it.
  int reached = 0;    ///< Episodes that came to this state.
  int passed = 0;     ///< Those that left it for a later one.
};

/// What all episodes amount to.
struct EvaluationResult {
  int true_successes = 0;
  int perceived_successes = 0;
  int disagreements = 0;        ///< Episodes whose success camera and truth judge differently.
  int state_disagreements = 0;  ///< Looks after which camera and truth name different states.
  std::array<StateTally, 4> per_step;
  double seconds_sim = 0;
  std::vector<Episode> episodes;
};

/// Runs one episode. Depends on (policy, config, index) only.
/// @param frames if set, is given every action's; finishing it is left to the caller.
Episode RunEpisode(Environment& environment, const Agent& agent, const EvaluationConfig& config,
                   int index, EpisodeFrames* frames = nullptr);

/// Runs all episodes, greedily, and writes frames episodeNNN_actionMM of those that the config asks
/// for. @throws RunError if `stop` becomes true, InputError or RunError if frames cannot be
/// written.
EvaluationResult Evaluate(Workers& workers, const Agent& agent, const EvaluationConfig& config,
                          const std::function<bool()>& stop);

/// Sums up; Evaluate's last step.
EvaluationResult Tally(std::vector<Episode> episodes);

}  // namespace gusset
