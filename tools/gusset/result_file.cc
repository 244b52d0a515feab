#include "tools/gusset/result_file.h"

#include <filesystem>

#include "agents/run_folder.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

bool IsResult(const std::string& file, const std::string& key) {
  try {
    const nlohmann::json document = ReadJson(file);
    return document.is_object() && document.contains(key);
  } catch (const InputError&) {
    return false;  // not JSON
  }
}

}  // namespace

void CheckResultFile(const std::string& file, const std::string& key) {
  CheckWritable(file);
  if (!Exists(file) || WritesThrough(file)) return;
  std::error_code none;
  if (std::filesystem::file_size(file, none) == 0 || IsResult(file, key)) return;
  throw InputError("--out: " + file + " is there already and is not a result of this command");
}

}  // namespace gusset
