#pragma once

#include "agents/deep/aten.h"

namespace gusset {

/// Q-values that DQN learns towards: r + gamma Q_target(s', a'), r where the episode ends. a' is
/// the best action of the target network itself (Mnih et al. 2015), or with double Q-learning of
/// the network that learns (van Hasselt et al. 2016, Eq. 4). Ties: the lowest index.
/// @param next_target, next_online  Q(s', .) by either network, (batch, actions).
/// @param allowed  which actions s' has, (batch, actions) of bool.
/// @param reward, goes_on  (batch); goes_on is 0 where the episode ends, else 1.
/// @returns (batch), without gradient.
at::Tensor DqnTargets(const at::Tensor& next_target, const at::Tensor& next_online,
                      const at::Tensor& allowed, const at::Tensor& reward,
                      const at::Tensor& goes_on, double gamma, bool double_q);

/// Mean Huber loss, of threshold 1, of Q(s, a) against its targets.
/// @param q (batch, actions). @param action, target (batch).
at::Tensor DqnLoss(const at::Tensor& q, const at::Tensor& action, const at::Tensor& target);

}  // namespace gusset
