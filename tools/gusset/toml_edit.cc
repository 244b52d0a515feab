#include "tools/gusset/toml_edit.h"

#include <algorithm>

namespace gusset {
namespace {

std::string_view Trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

// The line without its comment; no value that is replaced holds a '#'.
std::string_view WithoutComment(std::string_view line) { return line.substr(0, line.find('#')); }

std::vector<std::string> Lines(std::string_view text) {
  std::vector<std::string> lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines.emplace_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace

std::string ReplaceTomlValues(std::string_view text, std::string_view section,
                              const std::vector<std::pair<std::string, std::string>>& values) {
  std::vector<std::string> lines = Lines(text);
  const std::string header = "[" + std::string(section) + "]";
  const auto is_header = [&](const std::string& line) {
    return Trimmed(WithoutComment(line)) == header;
  };
  auto begin = std::ranges::find_if(lines, is_header);
  if (begin == lines.end()) {
    if (!lines.empty() && !lines.back().empty()) lines.emplace_back();
    lines.push_back(header);
    begin = lines.end() - 1;
  }
  const auto starts_table = [](const std::string& line) { return Trimmed(line).starts_with('['); };
  const auto first = static_cast<std::size_t>(begin - lines.begin()) + 1;
  for (const auto& [key, value] : values) {
    const auto end =
        std::find_if(lines.begin() + static_cast<std::ptrdiff_t>(first), lines.end(), starts_table);
    const auto found = std::find_if(
        lines.begin() + static_cast<std::ptrdiff_t>(first), end, [&](const std::string& line) {
          const auto equals = line.find('=');
          return equals != std::string::npos && Trimmed(line.substr(0, equals)) == key;
        });
    if (found == end) {
      // After the table's last line that says something.
      auto last = end;
      while (last - lines.begin() > static_cast<std::ptrdiff_t>(first) &&
             Trimmed(WithoutComment(*(last - 1))).empty()) {
        --last;
      }
      lines.insert(last, key + " = " + value);
      continue;
    }
    const std::string_view before = std::string_view(*found).substr(0, found->find('=') + 1);
    const auto comment = found->find('#');
    std::string line = std::string(before) + " " + value;
    if (comment != std::string::npos) line += "  " + found->substr(comment);
    *found = line;
  }
  std::string edited;
  for (const std::string& line : lines) edited += line + "\n";
  return edited;
}

}  // namespace gusset
