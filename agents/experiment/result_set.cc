#include "agents/experiment/result_set.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <functional>
#include <iterator>
#include <set>

#include "agents/evaluator.h"
#include "agents/experiment/commands.h"
#include "agents/experiment/intervals.h"
#include "agents/plots.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

// Points of each of Figure 5.6's curves.
constexpr int kCurvePoints = 10;

// What one seed has to say about one column.
struct Sample {
  double value = 0;
  int n = 0;  // of a rate
  int successes = 0;
  double wall_s = 0, sim_s = 0;
  std::string versions;
  std::string command;
};

struct Column {
  std::string name;
  std::string unit;
  std::function<std::optional<Sample>(int seed)> sample;
  std::function<bool(int seed)> failed;  // there will be no sample
  bool per_seed = true;                  // lines for single seeds are written too
};

std::string VersionsText(const nlohmann::json& versions) {
  std::string text;
  for (const auto& [name, version] : versions.items()) {
    text += (text.empty() ? "" : "; ") + name + " " +
            (version.is_string() ? version.get<std::string>() : version.dump());
  }
  return text;
}

class Rows {
 public:
  Rows(const ExperimentPlan& plan, const ExperimentOptions& options, const Finished& finished,
       const Published& published, const ResultContext& context)
      : plan_(plan),
        options_(options),
        finished_(finished),
        published_(published),
        context_(context) {}

  std::vector<ResultRow> Make() {
    for (const RowPlan& row : plan_.rows) {
      for (const Column& column : Columns(row)) Add(row, column);
    }
    return std::move(rows_);
  }

 private:
  // ---- which columns a table has

  std::vector<Column> Columns(const RowPlan& row) {
    if (row.table == "5.4") {
      return Joined({Totals(row, true), Effort(row)});
    }
    if (row.table == "5.5") return Rewards(row, "step");
    if (row.table == "5.6" || row.table == "5.7") return Joined({Steps(row), Episodes(row)});
    if (row.table == "fig5.6") return Curves(row);
    return Joined(
        {Totals(row, false), Effort(row), Rewards(row, "reward"), Steps(row), Episodes(row)});
  }

  static std::vector<Column> Joined(const std::vector<std::vector<Column>>& lists) {
    std::vector<Column> all;
    for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
    return all;
  }

  std::vector<Column> Totals(const RowPlan& row, bool beside_sum) {
    const auto total = [](const TrainingResult& t) { return t.total_reward(); };
    std::vector<Column> columns = {OfTraining(row, "total_reward", "reward", total)};
    // The thesis's row of Table 5.5, added up, is not always what its Table 5.4 says.
    if (beside_sum) columns.push_back(OfTraining(row, "sum_of_5.5", "reward", total));
    return columns;
  }

  std::vector<Column> Effort(const RowPlan& row) {
    return {OfTraining(row, "minutes", "min", [](const auto& t) { return t.sim_s / 60; }),
            OfTraining(row, "steps", "steps",
                       [](const auto& t) { return double(t.actions - t.extra_actions); }),
            OfTraining(row, "extra_actions", "steps",
                       [](const auto& t) { return double(t.extra_actions); })};
  }

  std::vector<Column> Rewards(const RowPlan& row, const std::string& name) {
    std::vector<Column> columns;
    for (int s = 0; s < 4; ++s) {
      columns.push_back(OfTraining(row, name + std::to_string(s + 1), "reward",
                                   [s](const TrainingResult& t) { return t.reward(s); }));
    }
    return columns;
  }

  std::vector<Column> Curves(const RowPlan& row) {
    std::vector<Column> columns;
    const int steps = plan_.training(row.training).steps;
    for (int s = 0; s < 4; ++s) {
      std::set<int> points;
      for (int i = 1; i <= kCurvePoints; ++i) points.insert(std::max(1, steps * i / kCurvePoints));
      for (const int step : points) {
        columns.push_back(OfTraining(
            row, "step" + std::to_string(s + 1) + "@" + std::to_string(step), "reward",
            [s, step](const TrainingResult& t) { return t.curve(s, step, kCurveWindow); }));
        columns.back().per_seed = false;
      }
    }
    return columns;
  }

  std::vector<Column> Steps(const RowPlan& row) {
    std::vector<Column> columns;
    if (!plan_.cell(row.cell).attempts) return columns;
    for (std::size_t s = 0; s < 4; ++s) {
      columns.push_back(OfTrial(row, "step" + std::to_string(s + 1), TrialKind::kAttempts, s));
    }
    return columns;
  }

  std::vector<Column> Episodes(const RowPlan& row) {
    return {OfTrial(row, "folded", TrialKind::kFolded, 0),
            OfTrial(row, "unfolded", TrialKind::kUnfolded, 0)};
  }

  // ---- where a column's numbers come from

  Column OfTraining(const RowPlan& row, const std::string& name, const std::string& unit,
                    const std::function<double(const TrainingResult&)>& measure) {
    Column column{name, unit, {}, {}};
    column.sample = [this, row, measure](int seed) -> std::optional<Sample> {
      const auto it = finished_.trainings.find({row.training, seed});
      if (it == finished_.trainings.end()) return std::nullopt;
      const TrainingResult& training = it->second;
      return Sample{measure(training),
                    0,
                    0,
                    training.wall_s,
                    training.sim_s,
                    VersionsText(training.versions),
                    TrainCommandLine(plan_.training(row.training), seed, context_.more_arguments)};
    };
    column.failed = [this, row](int seed) { return TrainingFailed(row, seed); };
    return column;
  }

  Column OfTrial(const RowPlan& row, const std::string& name, TrialKind kind, std::size_t entry) {
    Column column{name, "rate", {}, {}};
    column.sample = [this, row, kind, entry](int seed) -> std::optional<Sample> {
      const auto it = finished_.trials.find({row.cell, kind, seed});
      if (it == finished_.trials.end()) return std::nullopt;
      const TrialRecord& record = it->second;
      return Sample{0,
                    record.n[entry],
                    record.successes[entry],
                    record.wall_s,
                    record.sim_s,
                    VersionsText(record.versions),
                    TrialCommandLine(row, kind, seed)};
    };
    column.failed = [this, row, kind](int seed) {
      return TrainingFailed(row, seed) || finished_.failed_trials.contains({row.cell, kind, seed});
    };
    return column;
  }

  bool TrainingFailed(const RowPlan& row, int seed) const {
    return finished_.failed_trainings.contains({row.training, seed});
  }

  std::string TrialCommandLine(const RowPlan& row, TrialKind kind, int seed) const {
    if (kind == TrialKind::kAttempts) {
      return ExperimentCommandLine(row, options_, seed, 1, context_.more_arguments);
    }
    return EvaluateCommandLine(plan_.training(row.training),
                               {plan_.cell(row.cell), kind, seed, options_.episodes}, context_.out,
                               context_.more_arguments);
  }

  // ---- lines

  void Add(const RowPlan& row, const Column& column) {
    std::vector<Sample> samples;
    int failed = 0;
    for (int i = 0; i < options_.seeds; ++i) {
      const int seed = options_.first_seed + i;
      const std::optional<Sample> sample = column.sample(seed);
      failed += column.failed(seed);
      if (!sample) continue;
      samples.push_back(*sample);
      if (column.per_seed) Line(row, column, std::to_string(seed), {*sample}, sample->command);
    }
    const int settled = static_cast<int>(samples.size()) + failed;
    if (samples.empty() || settled < options_.seeds) return;
    Line(row, column, kPooled, samples,
         ExperimentCommandLine(row, options_, options_.first_seed, options_.seeds,
                               context_.more_arguments));
  }

  void Line(const RowPlan& row, const Column& column, const std::string& seed,
            const std::vector<Sample>& samples, const std::string& command) {
    ResultRow line;
    line.table = row.table;
    line.row = row.row;
    line.column = column.name;
    line.seed = seed;
    std::vector<double> values;
    int n = 0, successes = 0;
    for (const Sample& sample : samples) {
      values.push_back(sample.value);
      n += sample.n;
      successes += sample.successes;
      line.seconds_wall += sample.wall_s;
      line.seconds_sim += sample.sim_s;
    }
    std::optional<std::array<double, 2>> interval;
    if (column.unit == "rate") {
      line.n = n;
      line.successes = successes;
      if (n > 0) line.value = static_cast<double>(successes) / n;
      interval = WilsonInterval(successes, n);
    } else {
      line.value = Mean(values);
      interval = MeanInterval(values);
    }
    if (interval) {
      line.low = (*interval)[0];
      line.high = (*interval)[1];
    }
    line.published = published_.Find(row.table, row.row, column.name);
    line.unit = column.unit;
    line.command = command;
    // Seeds may have been trained by other builds.
    std::set<std::string> versions;
    for (const Sample& sample : samples) {
      if (!versions.insert(sample.versions).second) continue;
      line.versions += (line.versions.empty() ? "" : " | ") + sample.versions;
    }
    rows_.push_back(std::move(line));
  }

  const ExperimentPlan& plan_;
  const ExperimentOptions& options_;
  const Finished& finished_;
  const Published& published_;
  const ResultContext& context_;
  std::vector<ResultRow> rows_;
};

const std::vector<std::string>& CsvHead() {
  static const std::vector<std::string> head = {
      "table",   "row",          "column",        "seed",
      "n",       "successes",    "value",         "low",
      "high",    "published",    "published_low", "published_high",
      "unit",    "seconds_wall", "seconds_sim",   "command",
      "versions"};
  return head;
}

template <class T>
nlohmann::ordered_json OrNull(const std::optional<T>& value) {
  if (!value) return nullptr;
  return *value;
}

}  // namespace

std::vector<ResultRow> MakeResultRows(const ExperimentPlan& plan, const ExperimentOptions& options,
                                      const Finished& finished, const Published& published,
                                      const ResultContext& context) {
  return Rows(plan, options, finished, published, context).Make();
}

nlohmann::ordered_json ResultJson(const std::vector<ResultRow>& rows) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  for (const ResultRow& row : rows) {
    nlohmann::ordered_json line = {
        {"table", row.table}, {"row", row.row}, {"column", row.column}, {"seed", row.seed}};
    line["n"] = OrNull(row.n);
    line["successes"] = OrNull(row.successes);
    line["value"] = OrNull(row.value);
    line["low"] = OrNull(row.low);
    line["high"] = OrNull(row.high);
    const std::optional<double> none;
    line["published"] = OrNull(row.published ? row.published->value : none);
    line["published_low"] = OrNull(row.published ? row.published->low : none);
    line["published_high"] = OrNull(row.published ? row.published->high : none);
    line["unit"] = row.unit;
    line["seconds_wall"] = row.seconds_wall;
    line["seconds_sim"] = row.seconds_sim;
    line["command"] = row.command;
    line["versions"] = row.versions;
    all.push_back(std::move(line));
  }
  return all;
}

std::string ResultCsv(const std::vector<ResultRow>& rows, const std::vector<CsvRecord>& others) {
  std::string csv = CsvLine(CsvHead());
  for (const nlohmann::ordered_json& row : ResultJson(rows)) {
    std::vector<std::string> fields;
    for (const auto& [key, value] : row.items()) {
      std::string& field = fields.emplace_back();
      if (value.is_string()) field = value.get<std::string>();
      if (value.is_number_integer()) field = std::to_string(value.get<int>());
      if (value.is_number_float()) {
        field = fmt::format(fmt::runtime(key.starts_with("seconds") ? "{:.1f}" : "{:.6g}"),
                            value.get<double>());
      }
    }
    csv += CsvLine(fields);
  }
  for (const CsvRecord& record : others) csv += CsvLine(record.fields);
  return csv;
}

std::vector<CsvRecord> ReadResultLines(const std::filesystem::path& file) {
  std::vector<CsvRecord> records = ParseCsv(ReadFile(file), file.string());
  if (records.empty()) return records;
  const auto refuse = [&](const CsvRecord& record, const std::string& why) {
    throw InputError(file.string() + ":" + std::to_string(record.line) + ": " + why);
  };
  if (records[0].fields != CsvHead()) {
    refuse(records[0], "is not the head of an experiment's results");
  }
  const std::size_t columns = CsvHead().size();
  for (const CsvRecord& record : records) {
    if (record.fields.size() == columns) continue;
    refuse(record, "has " + std::to_string(record.fields.size()) + " fields, not " +
                       std::to_string(columns));
  }
  records.erase(records.begin());
  return records;
}

std::vector<CsvRecord> OtherLines(const std::vector<CsvRecord>& lines, const ExperimentPlan& plan,
                                  const std::vector<ResultRow>& rows, bool finished) {
  std::set<std::array<std::string, 4>> anew;
  for (const ResultRow& row : rows) anew.insert({row.table, row.row, row.column, row.seed});
  const auto is_replaced = [&](const CsvRecord& line) {
    const std::vector<std::string>& f = line.fields;
    const bool is_planned = std::ranges::any_of(
        plan.rows, [&](const RowPlan& row) { return row.table == f[0] && row.row == f[1]; });
    return is_planned && (finished || anew.contains({f[0], f[1], f[2], f[3]}) ||
                          anew.contains({f[0], f[1], f[2], kPooled}));
  };
  std::vector<CsvRecord> others;
  std::ranges::remove_copy_if(lines, std::back_inserter(others), is_replaced);
  return others;
}

}  // namespace gusset
