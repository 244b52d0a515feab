#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gusset {

/// A record of a CSV file (RFC 4180).
struct CsvRecord {
  int line = 0;  ///< On which it begins, from 1.
  std::vector<std::string> fields;
};

/// @throws InputError "NAME:LINE: ..." for a quote that does not close or stands amid a field.
std::vector<CsvRecord> ParseCsv(std::string_view text, const std::string& name);

/// A record as a line with its end (\n), fields quoted where they must be.
std::string CsvLine(const std::vector<std::string>& fields);

}  // namespace gusset
