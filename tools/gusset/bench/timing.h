#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gusset {

/// Wall and processor time of a piece of work. They differ where other programs wanted the cores.
struct Spent {
  double wall_s = 0;
  double cpu_s = 0;  ///< Of all threads of this process.
};

Spent TimeOf(const std::function<void()>& work);

/// @param values not empty.
double Median(std::vector<double> values);

/// Work that a rate can be given for: what has been spent on it, and how much was done each time.
struct Rate {
  std::vector<Spent> runs = {};
  double done = 0;  ///< Per run; simulated seconds, for example.

  double per_wall_s() const;  ///< By the median run.
  double per_cpu_s() const;   ///< What it would be on cores of its own.
  /// {"per_wall_s", "per_cpu_s", "wall_s": [...], "cpu_s": [...]}.
  nlohmann::ordered_json Json() const;
};

/// Median over `repetitions` of a Google Benchmark, in milliseconds of wall time an iteration.
/// @throws RunError if it reports an error.
double GoogleBenchmarkMs(const std::string& name,
                         const std::function<void(benchmark::State&)>& function, int repetitions);

}  // namespace gusset
