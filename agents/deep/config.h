#pragma once

#include <cstdint>

#include "base/config.h"

namespace gusset {

/// Settings of DQN and its variants. Section [dqn]. All defaults are those of `DQN` in
/// Stable-Baselines 2.10 (Hill et al. 2018), which the thesis ran; docs/agents.md lists them.
struct DqnConfig {
  double gamma = 0.99;                ///< Discount.
  double learning_rate = 5e-4;        ///< Adam's.
  int buffer_size = 50000;            ///< Transitions remembered; the oldest goes first.
  double exploration_initial = 1;     ///< Epsilon at the first step ...
  double exploration_final = 0.02;    ///< ... and after the fall, which is linear.
  double exploration_fraction = 0.1;  ///< Of the run's learnt steps over which epsilon falls.
  int train_freq = 1;                 ///< Steps from one update to the next.
  int batch_size = 32;                ///< Transitions drawn for an update, with replacement.
  int learning_starts = 1000;         ///< No update until more steps than these are over.
  int target_update = 500;            ///< Steps from one copy into the target network to the next.
  double max_grad_norm = 10;          ///< Of each weight matrix and each bias.

  template <class V>
  void Fields(V& v) {
    v("gamma", gamma, Range{0, 1});
    v("learning_rate", learning_rate, Range{0, 1});
    v("buffer_size", buffer_size, Range{1, 1000000});
    v("exploration_initial", exploration_initial, Range{0, 1});
    v("exploration_final", exploration_final, Range{0, 1});
    v("exploration_fraction", exploration_fraction, Range{0, 1});
    v("train_freq", train_freq, Range{1, 1000000});
    v("batch_size", batch_size, Range{1, 100000});
    v("learning_starts", learning_starts, Range{0, 1000000000});
    v("target_update", target_update, Range{1, 1000000000});
    v("max_grad_norm", max_grad_norm, Range{1e-6, 1e6});
  }
};

/// Settings of A2C. Section [a2c]. Defaults of `A2C` in Stable-Baselines 2.10.
struct A2cConfig {
  double gamma = 0.99;          ///< Discount.
  int n_steps = 5;              ///< Steps from one update to the next.
  double value_coef = 0.25;     ///< Weight of the value's loss.
  double entropy_coef = 0.01;   ///< Weight of the policy's entropy, which is sought; 0: none.
  double max_grad_norm = 0.5;   ///< Of all gradients together.
  double learning_rate = 7e-4;  ///< RMSProp's ...
  double alpha = 0.99;          ///< ... its decay ...
  double epsilon = 1e-5;        ///< ... and what is added under its root.

  template <class V>
  void Fields(V& v) {
    v("gamma", gamma, Range{0, 1});
    v("n_steps", n_steps, Range{1, 100000});
    v("value_coef", value_coef, Range{0, 100});
    v("entropy_coef", entropy_coef, Range{0, 100});
    v("max_grad_norm", max_grad_norm, Range{1e-6, 1e6});
    v("learning_rate", learning_rate, Range{0, 1});
    v("alpha", alpha, Range{0, 0.999999});
    v("epsilon", epsilon, Range{1e-12, 1});
  }
};

/// Settings of PPO. Section [ppo]. Defaults of `PPO2` in Stable-Baselines 2.10.
struct PpoConfig {
  double gamma = 0.99;            ///< Discount.
  double lambda = 0.95;           ///< Of the generalised advantage estimate; 0: one step.
  int n_steps = 128;              ///< Steps from one update to the next.
  int epochs = 4;                 ///< Times that an update goes through them.
  int minibatches = 4;            ///< Parts they are cut into; must divide n_steps.
  double clip = 0.2;              ///< How far ratio and value may move before they are cut off.
  double value_coef = 0.5;        ///< Weight of the value's loss.
  double entropy_coef = 0.01;     ///< Weight of the policy's entropy, which is sought; 0: none.
  double max_grad_norm = 0.5;     ///< Of all gradients together.
  double learning_rate = 2.5e-4;  ///< Adam's.

  template <class V>
  void Fields(V& v) {
    v("gamma", gamma, Range{0, 1});
    v("lambda", lambda, Range{0, 1});
    v("n_steps", n_steps, Range{2, 100000});
    v("epochs", epochs, Range{1, 1000});
    v("minibatches", minibatches, Range{1, 50000});
    v("clip", clip, Range{1e-6, 10});
    v("value_coef", value_coef, Range{0, 100});
    v("entropy_coef", entropy_coef, Range{0, 100});
    v("max_grad_norm", max_grad_norm, Range{1e-6, 1e6});
    v("learning_rate", learning_rate, Range{0, 1});
  }
};

/// What a network agent is made from.
struct DeepConfig {
  DqnConfig dqn;
  A2cConfig a2c;
  PpoConfig ppo;
  std::int64_t total_steps = 400;  ///< Learnt steps of the whole run; the trainer sets it.
  std::uint64_t seed = 1;          ///< Of initial weights and batches; the trainer sets it.
};

}  // namespace gusset
