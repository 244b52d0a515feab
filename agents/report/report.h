#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

namespace gusset {

/// What `gusset report` shows, as assets/report/report.js reads it: `groups` (runs that differ in
/// their seed only: learning curves, success per step, evaluations, reward maps), `tables` (of
/// results.csv) and `films`; pictures and videos are in it.
///
/// @param folders run folders, folders of `play`, or folders that hold results.csv and run folders
///   (`gusset experiment`).
/// @throws InputError naming file, line and key of what is broken, or a folder that holds nothing
///   to show.
nlohmann::ordered_json CollectReport(const std::vector<std::filesystem::path>& folders);

}  // namespace gusset
