#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "agents/experiment/published.h"

namespace gusset {

/// What `gusset report` shows, as assets/report/report.js reads it: `groups` (runs that differ in
/// their seed only: learning curves, success per step, evaluations, reward maps), `tables` (of
/// results.csv) and `films`; pictures and videos are in it. Learners that the thesis trained carry
/// its figures.
///
/// @param folders run folders, folders of `play`, or folders that hold results.csv and run folders
///   (`gusset experiment`).
/// @throws InputError naming file, line and key of what is broken, or a folder that holds nothing
///   to show.
nlohmann::ordered_json CollectReport(const std::vector<std::filesystem::path>& folders,
                                     const Published& published);

}  // namespace gusset
