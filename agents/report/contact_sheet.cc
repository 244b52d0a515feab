#include "agents/report/contact_sheet.h"

#include <optional>

#include "agents/report/dumped_action.h"
#include "agents/report/html_page.h"
#include "base/files.h"

namespace gusset {

void WriteContactSheet(const std::filesystem::path& folder) {
  nlohmann::ordered_json actions = nlohmann::ordered_json::array();
  for (const DumpedAction& action : ReadDumpedActions(folder)) actions.push_back(action.ToJson());
  WriteFileAtomic(folder / kContactSheet, FillPage("contact_sheet", {{"actions", actions}}));
}

}  // namespace gusset
