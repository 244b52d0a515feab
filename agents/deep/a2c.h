#pragma once

#include <span>
#include <vector>

#include "agents/deep/aten.h"
#include "agents/deep/experience.h"

namespace gusset {

/// Discounted returns within a rollout: R_i = r_i + gamma R_{i+1} where step i + 1 follows on from
/// step i, r_i + gamma V(s'_i) where it does not or the rollout ends, r_i where the episode ends.
/// @param next_values V(s'_i), one per step.
std::vector<double> BootstrappedReturns(std::span<const Experience> rollout,
                                        std::span<const float> next_values, double gamma);

/// A2C's loss: mean(-A log pi(a|s)) + value_coef mean((V - R)^2) - entropy_coef entropy, with
/// A = R - V taken as a number.
/// @param log_policy (n, actions). @param action, value, returns (n).
at::Tensor A2cLoss(const at::Tensor& log_policy, const at::Tensor& action, const at::Tensor& value,
                   const at::Tensor& returns, double value_coef, double entropy_coef);

}  // namespace gusset
