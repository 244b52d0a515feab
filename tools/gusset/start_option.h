#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "agents/ports/scene_port.h"

namespace gusset {

/// --start and --pose.
struct StartOption {
  std::string start = "folded";
  std::string pose = "near";

  void AddTo(CLI::App& app) {
    app.add_option("--start", start, "How the bag lies at first")
        ->check(CLI::IsMember({"folded", "unfolded"}))
        ->capture_default_str();
    app.add_option("--pose", pose, "Where: near the middle and square to it, or any")
        ->check(CLI::IsMember({"near", "any"}))
        ->capture_default_str();
  }
  StartKind kind() const {
    if (pose == "any") {
      return start == "folded" ? StartKind::kFoldedAnyPose : StartKind::kUnfoldedAnyPose;
    }
    return start == "folded" ? StartKind::kFolded : StartKind::kUnfolded;
  }
};

}  // namespace gusset
