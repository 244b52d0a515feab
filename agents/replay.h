#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "agents/environment.h"

namespace gusset {

/// Lines of a run's steps.jsonl, or of failed_step.json after the last of them.
/// @throws InputError naming file and line.
std::vector<nlohmann::json> ReadRunSteps(const std::filesystem::path& run);

/// The world as it was before logged action `step`, made again from the start that it goes back to:
/// an action's outcome depends on (snapshot, sensor seed, action) alone, and the log holds all
/// three.
/// @throws InputError if there is no such step or its line lacks something.
Snapshot WorldBefore(Environment& environment, const std::vector<nlohmann::json>& steps, int step);

}  // namespace gusset
