#pragma once

#include <filesystem>

#include "base/error.h"

namespace gusset {

/// Writes FOLDER/contact_sheet.html: every action whose frames lie in the folder (its PREFIX.json
/// says what they show) with thumbnails of its overlays, to be filtered by state and outcome. Opens
/// without a network; it shows the pictures beside it.
/// @throws InputError naming file and key of what is not as FrameWriter writes it, and RunError.
void WriteContactSheet(const std::filesystem::path& folder);

/// What `work` returns; afterwards the folder has a contact sheet, also if the work was given up.
template <class Work>
auto WithContactSheet(const std::filesystem::path& folder, Work work) {
  try {
    auto result = work();
    WriteContactSheet(folder);
    return result;
  } catch (const RunError&) {
    try {
      WriteContactSheet(folder);
    } catch (const std::exception&) {
      // No room for it either; what ended the work is what matters.
    }
    throw;
  }
}

}  // namespace gusset
