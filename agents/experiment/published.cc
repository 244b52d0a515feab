#include "agents/experiment/published.h"

#include <cmath>
#include <limits>

#include "agents/evaluator.h"
#include "base/config.h"
#include "base/error.h"

namespace gusset {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::string Key(const std::string& table, const std::string& row, const std::string& column) {
  return table + "/" + row + "/" + column;
}

// One table of the file: a list of numbers per row.
struct PublishedTable {
  std::string name;
  std::vector<std::string> rows;
  std::vector<std::string> columns;
  Range bounds;
  std::vector<std::vector<double>> values = {};

  template <class V>
  void Fields(V& v) {
    for (std::size_t i = 0; i < rows.size(); ++i) v(rows[i].c_str(), values[i], bounds);
  }
};

}  // namespace

Published Published::Load(const std::filesystem::path& file) {
  ConfigTree tree;
  tree.Load(file);
  const std::vector<std::string> agents = {"pi100", "pi50", "pi30", "pi10", "dqn", "a2c"};
  const std::vector<std::string> steps = {"step1", "step2", "step3", "step4"};
  std::vector<std::string> tries = steps;
  tries.insert(tries.end(), {"folded", "unfolded"});
  Published published;
  for (PublishedTable table :
       {PublishedTable{"5.4", agents, {"total_reward", "minutes", "steps"}, {-0.4, 10000}},
        PublishedTable{"5.5", agents, steps, {-0.1, 1}},
        PublishedTable{"5.6", agents, tries, {0, kPublishedTrials}},
        PublishedTable{"5.7", {"bag1", "bag2", "bag3"}, tries, {0, kPublishedTrials}}}) {
    std::string section = "table_" + table.name;
    section.replace(section.find('.'), 1, "_");
    table.values.assign(table.rows.size(), std::vector<double>(table.columns.size(), kMissing));
    tree.Read(section, table);
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      if (!std::isnan(table.values[r][0])) continue;
      throw InputError(file.string() + ": " + section + "." + table.rows[r] + " is missing");
    }
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      for (std::size_t c = 0; c < table.columns.size(); ++c) {
        PublishedCell cell{table.values[r][c]};
        if (table.name == "5.6" || table.name == "5.7") {
          const auto ci = WilsonInterval(static_cast<int>(cell.value), kPublishedTrials);
          cell = {cell.value / kPublishedTrials, ci[0], ci[1]};
        }
        published.cells_[Key(table.name, table.rows[r], table.columns[c])] = cell;
      }
    }
    // The same number under both names: as printed, and as the row of Table 5.5 adds up to.
    if (table.name != "5.5") continue;
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      double sum = 0;
      for (const double x : table.values[r]) sum += x;
      published.cells_[Key("5.4", table.rows[r], "sum_of_5.5")] = {sum};
    }
  }
  tree.RefuseUnknown();
  return published;
}

std::optional<PublishedCell> Published::Find(const std::string& table, const std::string& row,
                                             const std::string& column) const {
  const auto it = cells_.find(Key(table, row, column));
  if (it == cells_.end()) return std::nullopt;
  return it->second;
}

}  // namespace gusset
