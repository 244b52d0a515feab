#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include "agents/experiment/result_set.h"

namespace gusset {
namespace {

// As many columns beside each other as a line of a terminal holds.
constexpr std::size_t kColumnsAtOnce = 6;
constexpr int kWidth = 15;

std::string TitleOf(const std::string& table) {
  const std::string ours = " (ours of all seeds, 95 % interval; the thesis's below)";
  if (table == "5.4") return "Table 5.4: reward in all, training time in minutes, steps" + ours;
  if (table == "5.5") return "Table 5.5: mean reward per step in training" + ours;
  if (table == "5.6") return "Table 5.6: success of each step and of the task, Bag 1" + ours;
  if (table == "5.7") return "Table 5.7: the policy of pi100 with other bags and poses" + ours;
  if (table == "updates") return "Pi-learning's update rules (95 % interval)";
  if (table == "baselines") return "Other learners (95 % interval)";
  return "Ablations (95 % interval)";
}

std::string Number(const std::string& unit, double value) {
  if (unit == "rate") return fmt::format("{:.0f}", 100 * value);
  if (unit == "reward") return fmt::format("{:.3f}", value);
  return fmt::format("{:.0f}", value);
}

std::string CellText(const std::string& unit, std::optional<double> value,
                     std::optional<double> low, std::optional<double> high) {
  if (!value) return "-";
  std::string text = Number(unit, *value) + (unit == "rate" ? "%" : "");
  if (!low || !high) return text;
  const std::string to = *high < 0 || *low < 0 ? ".." : "-";
  if (unit == "reward") return text + fmt::format(" {:.2f}{}{:.2f}", *low, to, *high);
  return text + " " + Number(unit, *low) + to + Number(unit, *high);
}

template <class T>
void AddOnce(std::vector<T>& list, const T& one) {
  if (std::ranges::find(list, one) == list.end()) list.push_back(one);
}

// The lines of one table with their columns beside each other, some at a time.
std::string TableText(const std::string& table, const std::vector<ResultRow>& rows) {
  std::vector<std::string> names, columns;
  for (const ResultRow& row : rows) {
    AddOnce(names, row.row);
    AddOnce(columns, row.column);
  }
  std::size_t label = 8;
  for (const std::string& name : names) label = std::max(label, name.size());
  const auto find = [&](const std::string& name, const std::string& column) {
    const auto it = std::ranges::find_if(
        rows, [&](const ResultRow& row) { return row.row == name && row.column == column; });
    return it == rows.end() ? nullptr : &*it;
  };
  std::string text = "\n" + TitleOf(table) + "\n";
  for (std::size_t first = 0; first < columns.size(); first += kColumnsAtOnce) {
    const std::size_t end = std::min(columns.size(), first + kColumnsAtOnce);
    std::string line(label, ' ');
    for (std::size_t c = first; c < end; ++c) line += fmt::format(" {:>{}}", columns[c], kWidth);
    text += line + "\n";
    for (const std::string& name : names) {
      std::string ours = fmt::format("{:<{}}", name, label);
      std::string theirs = fmt::format("{:>{}}", "thesis", label);
      bool any = false;
      for (std::size_t c = first; c < end; ++c) {
        const ResultRow* row = find(name, columns[c]);
        const bool has = row != nullptr && row->published;
        any = any || has;
        ours += fmt::format(
            " {:>{}}", row == nullptr ? "" : CellText(row->unit, row->value, row->low, row->high),
            kWidth);
        theirs += fmt::format(" {:>{}}",
                              has ? CellText(row->unit, row->published->value, row->published->low,
                                             row->published->high)
                                  : "",
                              kWidth);
      }
      text += ours + "\n";
      if (any) text += theirs + "\n";
    }
  }
  return text;
}

}  // namespace

std::string ResultText(const std::vector<ResultRow>& rows) {
  std::string text;
  for (const std::string& table : ExperimentTables()) {
    std::vector<ResultRow> pooled;
    for (const ResultRow& row : rows) {
      if (row.table == table && row.seed == kPooled) pooled.push_back(row);
    }
    if (pooled.empty()) continue;
    // Figure 5.6 is for the eye, not for reading.
    if (table == "fig5.6") {
      text +=
          fmt::format("\nFigure 5.6: {} points of learning curves in results.csv\n", pooled.size());
    } else {
      text += TableText(table, pooled);
    }
  }
  return text;
}

}  // namespace gusset
