#pragma once

#include <chrono>

#include "agents/experiment/runner.h"

namespace gusset {

/// Tells on stderr how an experiment goes, with rate and time left: on a terminal one line that
/// keeps changing below the list of what is finished, elsewhere plain lines, one for whatever is
/// finished and one a minute while nothing is.
class ExperimentProgressPrinter {
 public:
  explicit ExperimentProgressPrinter(bool silent);
  ~ExperimentProgressPrinter();
  void operator()(const ExperimentProgress& progress);

 private:
  bool silent_;
  bool terminal_;
  bool line_open_ = false;  // the changing line is there
  std::chrono::steady_clock::time_point told_ = std::chrono::steady_clock::now();
};

}  // namespace gusset
