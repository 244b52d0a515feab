#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "agents/experiment/plan.h"
#include "agents/experiment/published.h"
#include "agents/experiment/training_result.h"
#include "agents/experiment/trial.h"
#include "base/csv.h"

namespace gusset {

/// What a line that sums up all seeds has as its own.
inline constexpr const char* kPooled = "pooled";

/// One line of results.csv: a measure of one row of a table, for one seed or pooled over all.
struct ResultRow {
  std::string table, row, column;
  std::string seed;                          ///< A number, or kPooled.
  std::optional<int> n, successes;           ///< Of a rate.
  std::optional<double> value;               ///< The rate or the mean; nothing for n = 0.
  std::optional<double> low, high;           ///< 95 %: Wilson's for a rate, Student's t for a mean.
  std::optional<PublishedCell> published;    ///< What the thesis has there.
  std::string unit;                          ///< "rate", "reward", "min", "steps".
  double seconds_wall = 0, seconds_sim = 0;  ///< Of the trainings or trials that it sums up.
  std::string command;                       ///< Repeats the row.
  std::string versions;
};

/// All that is finished of an experiment, and what turned out not to be finishable.
struct Finished {
  std::map<std::pair<std::string, int>, TrainingResult> trainings;        ///< By name and seed.
  std::map<std::tuple<std::string, TrialKind, int>, TrialRecord> trials;  ///< By cell.
  std::set<std::pair<std::string, int>> failed_trainings;
  std::set<std::tuple<std::string, TrialKind, int>> failed_trials;
};

/// What commands in the result set refer to.
struct ResultContext {
  std::string out;             ///< The experiment's folder, as it was given.
  std::string more_arguments;  ///< --config and --set, with a space before each.
};

/// The result set, in the order of the plan: per row and column one line for each seed that is
/// finished, and a pooled one once all are, but for those that cannot be. The same whatever was
/// finished first.
std::vector<ResultRow> MakeResultRows(const ExperimentPlan& plan, const ExperimentOptions& options,
                                      const Finished& finished, const Published& published,
                                      const ResultContext& context);

/// results.csv (RFC 4180, lines end in \n), with a head: `rows`, then the lines of `others`.
std::string ResultCsv(const std::vector<ResultRow>& rows,
                      const std::vector<CsvRecord>& others = {});

/// The lines of a results.csv, without its head.
/// @throws InputError naming file and line if it is not as ResultCsv writes it, or cannot be read.
std::vector<CsvRecord> ReadResultLines(const std::filesystem::path& file);

/// Those of `lines` that stay beside `rows`: all of rows that are not in the plan, of other tables
/// and trainings; and unless the plan is `finished`, what of its own rows is not there anew, of
/// other seeds too, until the column is pooled.
std::vector<CsvRecord> OtherLines(const std::vector<CsvRecord>& lines, const ExperimentPlan& plan,
                                  const std::vector<ResultRow>& rows, bool finished);

/// The same as JSON: an array of objects with the head's keys; what is empty is null.
nlohmann::ordered_json ResultJson(const std::vector<ResultRow>& rows);

/// The pooled lines as tables for people, ours above the thesis's.
std::string ResultText(const std::vector<ResultRow>& rows);

}  // namespace gusset
