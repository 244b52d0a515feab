#include "tools/gusset/bench/timing.h"

#include <time.h>

#include <algorithm>
#include <chrono>

#include "base/error.h"

namespace gusset {
namespace {

double ProcessorTime() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::vector<double> Times(const std::vector<Spent>& runs, double Spent::*which) {
  std::vector<double> times;
  for (const Spent& run : runs) times.push_back(run.*which);
  return times;
}

// Keeps the runs instead of printing them.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& report) override {
    for (const Run& run : report) {
      if (run.error_occurred) error = run.error_message;
      if (run.run_type == Run::RT_Iteration && !run.error_occurred) {
        ms.push_back(1e3 * run.real_accumulated_time / static_cast<double>(run.iterations));
      }
    }
  }

  std::vector<double> ms;
  std::string error;
};

}  // namespace

Spent TimeOf(const std::function<void()>& work) {
  const double cpu_before = ProcessorTime();
  const auto start = std::chrono::steady_clock::now();
  work();
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  return {wall.count(), ProcessorTime() - cpu_before};
}

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

double Rate::per_wall_s() const { return done / Median(Times(runs, &Spent::wall_s)); }

double Rate::per_cpu_s() const { return done / Median(Times(runs, &Spent::cpu_s)); }

nlohmann::ordered_json Rate::Json() const {
  return {{"per_wall_s", per_wall_s()},
          {"per_cpu_s", per_cpu_s()},
          {"wall_s", Times(runs, &Spent::wall_s)},
          {"cpu_s", Times(runs, &Spent::cpu_s)}};
}

double GoogleBenchmarkMs(const std::string& name,
                         const std::function<void(benchmark::State&)>& function, int repetitions) {
  benchmark::ClearRegisteredBenchmarks();
  benchmark::RegisterBenchmark(name.c_str(), function)->Repetitions(repetitions)->UseRealTime();
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector, name);
  benchmark::ClearRegisteredBenchmarks();
  if (!collector.error.empty()) throw RunError("bench: " + name + ": " + collector.error);
  return Median(collector.ms);
}

}  // namespace gusset
