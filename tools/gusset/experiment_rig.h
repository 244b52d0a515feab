#pragma once

#include "agents/experiment/runner.h"
#include "tools/gusset/settings.h"

namespace gusset {

/// An experiment's trainings and trials in simulated worlds, configured and performed as by
/// `gusset train` and `gusset evaluate`.
class SimExperimentRig final : public ExperimentRig {
 public:
  /// @param common  --config and --set, for trainings and trials alike; the grid's own values win.
  explicit SimExperimentRig(const CommonOptions& common) : common_(common) {}

  /// Finds what is wrong with the settings, or missing in this build, before any work begins.
  /// @throws InputError.
  void CheckSettings(const ExperimentPlan& plan) const;

  void Train(const TrainingPlan& plan, int seed, const std::filesystem::path& folder,
             std::atomic<int>& count, const Stop& stop) override;
  bool HasTrained(const TrainingPlan& plan, int seed, const std::filesystem::path& folder) override;
  Subject Open(const TrainingPlan& plan, const CellPlan& cell,
               const std::filesystem::path& folder) override;

 private:
  Settings SettingsOf(const TrainingPlan& plan, int seed) const;
  CommonOptions common_;
};

}  // namespace gusset
