#pragma once

#include <filesystem>
#include <functional>
#include <memory>

#include "agents/environment.h"
#include "agents/run_folder.h"
#include "agents/trainer.h"
#include "tools/gusset/settings.h"

namespace gusset {

/// Puts something round an environment, such as a counter.
using EnvironmentWrap = std::function<std::unique_ptr<Environment>(std::unique_ptr<Environment>)>;

/// The run in `out`. @throws InputError naming a value that it was begun with and `settings` have
/// otherwise.
RunFolder OpenRun(const std::filesystem::path& out, const Settings& settings);

/// What `gusset train` does: makes `out` a run folder, or with `resume` takes up the run there;
/// trains to the end; draws learning curve and reward maps.
/// @param jobs  worlds that run at once.
/// @param wrap  if set, put round every world's environment.
/// @throws InputError, RunError as Train does; RunError if a stop is asked for while it draws.
TrainSummary TrainInFolder(const std::filesystem::path& out, const Settings& settings, bool resume,
                           int jobs, const std::function<bool()>& stop,
                           const EnvironmentWrap& wrap = {});

/// Whether the pictures of the training in `run` were all drawn.
bool HasPictures(const std::filesystem::path& run);

}  // namespace gusset
