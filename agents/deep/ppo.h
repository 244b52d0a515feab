#pragma once

#include <span>
#include <vector>

#include "agents/deep/aten.h"
#include "agents/deep/config.h"
#include "agents/deep/experience.h"

namespace gusset {

/// Generalised advantage estimates (Schulman et al. 2016, Eq. 16): A_i = d_i + gamma lambda A_{i+1}
/// where step i + 1 follows on from step i, else d_i, with d_i = r_i + gamma V(s_{i+1}) - V(s_i).
/// The value of what comes after is 0 where the episode ends, and V(s'_i) where nothing follows.
/// @param values, next_values V(s_i) and V(s'_i), one per step.
std::vector<double> GeneralisedAdvantages(std::span<const Experience> rollout,
                                          std::span<const float> values,
                                          std::span<const float> next_values, double gamma,
                                          double lambda);

/// PPO's clipped loss (Schulman et al. 2017, Eq. 7 and 9), the value clipped alike as in
/// Stable-Baselines 2: mean(max(-A r, -A clip(r, 1 - c, 1 + c))) + value_coef / 2
/// mean(max((V - R)^2, (V_old + clip(V - V_old, -c, c) - R)^2)) - entropy_coef entropy, with
/// r = pi(a|s) / pi_old(a|s).
/// @param log_policy (n, actions); all others (n), taken as numbers but for `value`.
at::Tensor PpoLoss(const at::Tensor& log_policy, const at::Tensor& action, const at::Tensor& value,
                   const at::Tensor& old_log_chosen, const at::Tensor& old_value,
                   const at::Tensor& advantage, const at::Tensor& returns, const PpoConfig& config);

}  // namespace gusset
