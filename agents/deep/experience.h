#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "agents/agent.h"
#include "agents/deep/aten.h"

namespace gusset {

/// How many of a state's features a network sees: A_bag / A_bmax and A_o / A_omax.
inline constexpr int kSeenFeatures = 2;

/// What is kept of a Transition, in the numbers that networks compute with.
struct Experience {
  int state = 0;
  int action = 0;
  int next_state = 0;    ///< An acting state; 0 where `over`.
  bool over = false;     ///< The episode ended: nothing follows that would be worth anything.
  bool follows = false;  ///< As in Transition.
  float reward = 0;
  std::array<float, kSeenFeatures> features = {};
  std::array<float, kSeenFeatures> next_features = {};
};

/// @param states how many states act.
Experience ExperienceOf(const Transition& transition, int states);

/// What the networks observe: the state, one-hot, then the features seen (0 where there are none).
/// @returns (1, states + kSeenFeatures).
at::Tensor Observation(int state, std::span<const double> features, int states);
/// Of many, before or after the action. @returns (n, states + kSeenFeatures).
at::Tensor Observations(std::span<const Experience> experiences, int states, bool after);

/// One number of each experience. @returns (n), of type at::kLong or at::kFloat.
at::Tensor States(std::span<const Experience> experiences, bool after);
at::Tensor Actions(std::span<const Experience> experiences);
at::Tensor Rewards(std::span<const Experience> experiences);
/// 1 where the episode goes on, else 0.
at::Tensor GoesOn(std::span<const Experience> experiences);

/// Which outputs are actions of which state. @returns (states, max n_actions) of bool.
at::Tensor ActionMask(const std::vector<int>& n_actions);

nlohmann::json SaveExperiences(std::span<const Experience> experiences);
/// @throws InputError naming `key` unless every one fits `n_actions` and there are at most `most`.
std::vector<Experience> LoadExperiences(const nlohmann::json& saved, const std::string& key,
                                        const std::vector<int>& n_actions, std::size_t most);

}  // namespace gusset
