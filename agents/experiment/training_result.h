#pragma once

#include <array>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

namespace gusset {

/// What a finished training amounts to, read from its run folder.
struct TrainingResult {
  std::array<std::vector<double>, 4> rewards;  ///< Of the learnt steps of each state, in order.
  int actions = 0;                             ///< All of them.
  int extra_actions = 0;                       ///< Those that nothing was learnt from.
  double sim_s = 0;                            ///< Simulated time of all actions.
  double wall_s = 0;                           ///< Their wall time, without the making of starts.
  nlohmann::json versions;                     ///< Of the program and what it rests on.

  /// Mean reward of a state's learnt steps: Table 5.5. @param state 0 to 3.
  double reward(int state) const;
  /// Sum of the four: Table 5.4.
  double total_reward() const;
  /// Mean of the last `window` rewards of a state after `step` of its steps: Figure 5.6.
  double curve(int state, int step, int window) const;
};

/// @throws InputError naming file and line of what is not as the trainer writes it.
TrainingResult ReadTrainingResult(const std::filesystem::path& run);

}  // namespace gusset
