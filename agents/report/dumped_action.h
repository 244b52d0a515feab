#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gusset {

/// How an action came out, for people to filter by.
///
/// "success": the task is done, by ground truth; "false success": only the camera says so;
/// "advanced": the camera saw a later state follow; "lost": it saw no bag any more though nothing
/// was carried; "not carried": close + carry without success; "no progress": none of these.
std::string OutcomeName(int state, int next_state, bool done, bool success, bool success_true);

/// One action whose frames were kept (--dump), as its PREFIX.json tells.
struct DumpedAction {
  std::filesystem::path prefix;  ///< Of its files, with folder.
  std::optional<int> episode;    ///< Of an evaluation.
  int step = 0;                  ///< In the run, or in the episode.
  int state = 0;                 ///< As seen before the action.
  int action = 0;
  double reward = 0;
  int next_state = 0;                   ///< As seen afterwards.
  int next_state_true = 0;              ///< By ground truth.
  std::string outcome;                  ///< OutcomeName.
  bool disagree = false;                ///< Camera and truth judge state or success differently.
  std::optional<bool> episode_success;  ///< By ground truth.
  std::string note;                     ///< Why the primitive was not completed.

  /// For the pages. Files are named without their folder.
  nlohmann::ordered_json ToJson() const;
};

/// All actions whose frames lie in `folder`, by episode and step. JSON files that tell of no action
/// are passed over.
/// @throws InputError naming file and key of what is broken.
std::vector<DumpedAction> ReadDumpedActions(const std::filesystem::path& folder);

/// What WriteContactSheet calls its page.
inline constexpr const char* kContactSheet = "contact_sheet.html";

/// Removes those whose names begin with `begin`, their pictures and the contact sheet, lest what an
/// earlier command left be taken for a result of the next. Nothing else goes.
/// @throws std::filesystem::filesystem_error if something cannot be removed.
void RemoveDumpedActions(const std::filesystem::path& folder, const std::string& begin);

}  // namespace gusset
