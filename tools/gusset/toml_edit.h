#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gusset {

/// A TOML text in which keys of one table have new values; every other byte, comments included,
/// stays as it is. Keys that the table lacks are added at its end, a table that is missing at the
/// text's. Meant for tables with a plain header `[section]` and one `key = value` per line.
/// @param values keys with their values as TOML has them.
std::string ReplaceTomlValues(std::string_view text, std::string_view section,
                              const std::vector<std::pair<std::string, std::string>>& values);

}  // namespace gusset
