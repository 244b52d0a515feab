#pragma once

#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/deep/experience.h"
#include "agents/deep/network.h"

namespace gusset {

/// log pi(a | s) of every action; -1e9, and so probability 0, for those that the state lacks.
/// @param logits (batch, actions). @param allowed (batch, actions) of bool.
at::Tensor LogPolicy(const at::Tensor& logits, const at::Tensor& allowed);
/// Mean entropy of the policies in a batch, in nats. @param log_policy (batch, actions).
at::Tensor Entropy(const at::Tensor& log_policy);

/// What A2C and PPO share: a policy and a value network that see the same observation, choice by
/// the policy's probabilities, and a stretch of experience that is learnt from when it is full.
class OnPolicyAgent : public Agent {
 public:
  /// In training an action drawn from the policy ("explored" if it is not the likeliest, with
  /// "epsilon" the probability of that); as a policy the likeliest, the lowest index among equals.
  Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
               Rng& rng) const override;
  void Learn(const Transition& transition) override;
  nlohmann::json Save() const override;
  void Load(const nlohmann::json& saved) override;
  std::string name() const override { return name_; }

 protected:
  /// @param n_steps steps from one update to the next.
  OnPolicyAgent(std::string name, const std::vector<int>& n_actions, int n_steps,
                std::uint64_t seed);
  /// Learns from n_steps steps in the order in which they were taken.
  virtual void Update(const std::vector<Experience>& rollout) = 0;

  int states() const { return static_cast<int>(n_actions_.size()); }
  std::vector<at::Tensor> parameters() const;
  /// Both networks on a rollout. @returns (n, actions) and (n).
  at::Tensor LogPolicyAt(std::span<const Experience> experiences) const;
  at::Tensor ValueAt(std::span<const Experience> experiences, bool after) const;
  /// Set by the heir's constructor.
  void set_optimizer(Optimizer optimizer) { optimizer_ = std::move(optimizer); }
  Optimizer& optimizer() { return optimizer_; }
  int updates() const { return updates_; }
  std::uint64_t seed() const { return seed_; }

 private:
  std::string name_;
  std::vector<int> n_actions_;
  int n_steps_;
  std::uint64_t seed_;
  at::Tensor mask_;
  Mlp policy_, value_;
  Optimizer optimizer_;
  std::vector<Experience> rollout_;
  int updates_ = 0;
};

}  // namespace gusset
