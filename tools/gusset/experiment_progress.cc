#include "tools/gusset/experiment_progress.h"

#include <spdlog/fmt/fmt.h>
#include <unistd.h>

#include <cstdio>

namespace gusset {
namespace {

constexpr std::chrono::seconds kHeartbeat{60};

std::string Duration(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

std::string Standing(const ExperimentProgress& progress) {
  std::string text = fmt::format("{} of {} done, {} actions", progress.units_done, progress.units,
                                 progress.actions);
  if (progress.actions == 0 || progress.units_done == progress.units) return text;
  return text + fmt::format(", {:.2f} actions/s, about {} left", progress.actions_per_s(),
                            Duration(progress.seconds_left()));
}

}  // namespace

ExperimentProgressPrinter::ExperimentProgressPrinter(bool silent)
    : silent_(silent), terminal_(::isatty(STDERR_FILENO) == 1) {}

ExperimentProgressPrinter::~ExperimentProgressPrinter() {
  if (line_open_) std::fputs("\n", stderr);
}

void ExperimentProgressPrinter::operator()(const ExperimentProgress& progress) {
  if (silent_) return;
  const auto now = std::chrono::steady_clock::now();
  if (terminal_) {
    std::string text = line_open_ ? "\r\033[K" : "";
    if (!progress.finished.empty()) text += progress.finished + "\n";
    std::fputs((text + Standing(progress)).c_str(), stderr);
    line_open_ = true;
    return;
  }
  if (progress.finished.empty() && now - told_ < kHeartbeat) return;
  told_ = now;
  const std::string what = progress.finished.empty() ? "" : progress.finished + "; ";
  std::fputs((what + Standing(progress) + "\n").c_str(), stderr);
}

}  // namespace gusset
