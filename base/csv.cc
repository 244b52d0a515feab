#include "base/csv.h"

#include "base/error.h"

namespace gusset {
namespace {

std::string Field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

}  // namespace

std::vector<CsvRecord> ParseCsv(std::string_view text, const std::string& name) {
  std::vector<CsvRecord> records;
  int line = 1;
  for (std::size_t i = 0; i < text.size();) {
    CsvRecord record{line, {""}};
    bool quoted = false;
    bool was_quoted = false;
    for (; i < text.size(); ++i) {
      const char c = text[i];
      if (c == '\n') ++line;
      std::string& field = record.fields.back();
      if (quoted) {
        if (c != '"') {
          field += c;
        } else if (i + 1 < text.size() && text[i + 1] == '"') {
          field += text[++i];
        } else {
          quoted = false;
        }
      } else if (c == '"') {
        if (!field.empty() || was_quoted) {
          throw InputError(name + ":" + std::to_string(line) + ": a quote amid a field");
        }
        quoted = was_quoted = true;
      } else if (c == ',') {
        record.fields.emplace_back();
        was_quoted = false;
      } else if (c == '\n') {
        ++i;
        break;
      } else if (c != '\r') {
        field += c;
      }
    }
    if (quoted) {
      throw InputError(name + ":" + std::to_string(record.line) + ": a quote does not close");
    }
    records.push_back(std::move(record));
  }
  return records;
}

std::string CsvLine(const std::vector<std::string>& fields) {
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i) line += (i == 0 ? "" : ",") + Field(fields[i]);
  return line + "\n";
}

}  // namespace gusset
