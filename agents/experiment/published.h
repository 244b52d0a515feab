#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gusset {

/// Trials behind each rate of Tables 5.6 and 5.7.
inline constexpr int kPublishedTrials = 10;

/// What the thesis prints for one cell of a table.
struct PublishedCell {
  double value = 0;
  std::optional<double> low = {}, high = {};  ///< 95 % by Wilson, where the value is a rate.
};

/// The thesis's own figures. File: assets/published/thesis.toml.
class Published {
 public:
  /// @throws InputError naming file, line, key, value and bound.
  static Published Load(const std::filesystem::path& file);
  /// @param table, row, column  as in the result set ("5.6", "pi100", "step1").
  std::optional<PublishedCell> Find(const std::string& table, const std::string& row,
                                    const std::string& column) const;

 private:
  std::map<std::string, PublishedCell> cells_;
};

}  // namespace gusset
