#include "agents/report/results_csv.h"

#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "base/csv.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

constexpr const char* kColumns[] = {
    "table", "row",       "column",        "seed",           "n",    "successes", "value", "low",
    "high",  "published", "published_low", "published_high", "unit", "command"};

// One record with its columns by name.
class Line {
 public:
  Line(const std::string& file, const CsvRecord& record,
       const std::map<std::string, std::size_t>& columns)
      : file_(file), record_(record), columns_(columns) {}

  const std::string& Text(const std::string& column) const {
    return record_.fields[columns_.at(column)];
  }
  std::optional<double> Number(const std::string& column) const {
    const std::string& text = Text(column);
    if (text.empty()) return std::nullopt;
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(number)) {
      Refuse(column, "must be a number");
    }
    return number;
  }
  std::optional<int> Count(const std::string& column, double most) const {
    const std::optional<double> number = Number(column);
    if (!number) return std::nullopt;
    if (*number < 0 || *number > most || *number != std::floor(*number)) {
      Refuse(column,
             "must be a whole number within [0, " + std::to_string(static_cast<long>(most)) + "]");
    }
    return static_cast<int>(*number);
  }
  std::optional<Estimate> Read(const std::string& value, const std::string& low,
                               const std::string& high) const {
    const std::optional<double> number = Number(value);
    if (!number) return std::nullopt;
    const Estimate estimate{*number, Number(low), Number(high)};
    if (estimate.low && estimate.high && *estimate.low > *estimate.high) {
      Refuse(low, "is above " + high + " = " + Text(high));
    }
    return estimate;
  }
  [[noreturn]] void Refuse(const std::string& column, const std::string& why) const {
    throw InputError(file_ + ":" + std::to_string(record_.line) + ": " + column + " = " +
                     Text(column) + " " + why);
  }

 private:
  const std::string& file_;
  const CsvRecord& record_;
  const std::map<std::string, std::size_t>& columns_;
};

void Add(const Line& line, ResultCell& cell) {
  const std::optional<int> n = line.Count("n", 1e9);
  const std::optional<int> successes = line.Count("successes", n.value_or(0));
  const std::optional<Estimate> ours = line.Read("value", "low", "high");
  if (n && ours && (ours->value < 0 || ours->value > 1))
    line.Refuse("value", "is not within [0, 1]");
  // The file has six digits of it.
  if (n && *n > 0 && successes && ours &&
      std::abs(ours->value - static_cast<double>(*successes) / *n) > 1e-5) {
    line.Refuse("value",
                "is not successes / n = " + line.Text("successes") + " / " + line.Text("n"));
  }
  if (line.Text("seed") != "pooled") {
    cell.seed_texts.push_back("seed " + line.Text("seed") + ": " + line.Text("value") +
                              (n ? " of " + line.Text("n") : ""));
    return;
  }
  cell.n = n;
  cell.successes = successes;
  cell.ours = ours;
  cell.command = line.Text("command");
}

}  // namespace

std::vector<ResultCell> ReadResults(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::vector<CsvRecord> records = ParseCsv(ReadFile(file), name);
  if (records.empty()) throw InputError(name + ": is empty");
  std::map<std::string, std::size_t> columns;
  for (std::size_t i = 0; i < records[0].fields.size(); ++i) columns[records[0].fields[i]] = i;
  for (const char* column : kColumns) {
    if (!columns.contains(column)) {
      throw InputError(name + ":1: column " + column + " is missing");
    }
  }
  std::vector<ResultCell> cells;
  struct Place {
    std::size_t cell;
    std::set<std::string> seeds;
  };
  std::map<std::tuple<std::string, std::string, std::string>, Place> places;
  for (std::size_t i = 1; i < records.size(); ++i) {
    const CsvRecord& record = records[i];
    if (record.fields.size() != records[0].fields.size()) {
      throw InputError(name + ":" + std::to_string(record.line) + ": has " +
                       std::to_string(record.fields.size()) + " fields, not " +
                       std::to_string(records[0].fields.size()));
    }
    const Line line(name, record, columns);
    const auto key = std::tuple(line.Text("table"), line.Text("row"), line.Text("column"));
    const auto [at, is_new] = places.try_emplace(key, Place{cells.size(), {}});
    if (!at->second.seeds.insert(line.Text("seed")).second) {
      line.Refuse("seed", "stands in an earlier line of this table, row and column");
    }
    if (is_new) {
      ResultCell& cell = cells.emplace_back();
      std::tie(cell.table, cell.row, cell.column) = key;
      cell.unit = line.Text("unit");
      cell.published = line.Read("published", "published_low", "published_high");
    }
    ResultCell& cell = cells[at->second.cell];
    if (line.Text("unit") != cell.unit) line.Refuse("unit", "was " + cell.unit + " before");
    Add(line, cell);
  }
  return cells;
}

}  // namespace gusset
