#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gusset {

/// A number with its 95 % interval.
struct Estimate {
  double value = 0;
  std::optional<double> low, high;
};

/// One cell of a table of results.csv.
struct ResultCell {
  std::string table, row, column, unit;
  std::optional<int> n, successes;      ///< Over all seeds, of a rate.
  std::optional<Estimate> ours;         ///< Pooled over all seeds.
  std::optional<Estimate> published;    ///< The thesis's.
  std::vector<std::string> seed_texts;  ///< "seed 1: 0.5", in the file's order.
  std::string command;                  ///< Repeats it.
};

/// The cells of an experiment's results.csv in the order of their first line. A cell without a
/// pooled line (its seeds have not all finished) has no `ours`.
/// @throws InputError naming file, line, column and bound.
std::vector<ResultCell> ReadResults(const std::filesystem::path& file);

}  // namespace gusset
