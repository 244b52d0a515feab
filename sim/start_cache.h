#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace gusset {

/// Keeps made starts on disk, since making one takes about as long as an action. Purely a saving of
/// time: a start is a function of its key, and a file that is missing, damaged or cannot be written
/// only means that it is made again. Folder: $GUSSET_CACHE, else $XDG_CACHE_HOME/gusset, else
/// ~/.cache/gusset; GUSSET_CACHE="" switches it off.
class StartCache {
 public:
  StartCache();
  /// @param key everything the start depends on but the sources, compiler and flags of this build,
  /// which are added to it: others may step the cloth otherwise.
  std::optional<std::string> Find(const std::string& key) const;
  void Keep(const std::string& key, const std::string& value) const;

 private:
  std::filesystem::path FileOf(const std::string& key) const;
  std::filesystem::path folder_;  // empty: off
};

}  // namespace gusset
