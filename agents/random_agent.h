#pragma once

#include <string>

#include "agents/agent.h"

namespace gusset {

/// The baseline: every afforded action with the same probability, in training and evaluation.
class RandomAgent final : public Agent {
 public:
  Decision Act(int, std::span<const double>, int n_actions, Mode, Rng& rng) const override {
    return {rng.Below(n_actions), true, 1.0};
  }
  void Learn(const Transition&) override {}
  nlohmann::json Save() const override { return nlohmann::json::object(); }
  void Load(const nlohmann::json&) override {}
  std::string name() const override { return "random"; }
};

}  // namespace gusset
