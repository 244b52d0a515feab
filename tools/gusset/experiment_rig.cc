#include "tools/gusset/experiment_rig.h"

#include "base/error.h"
#include "base/files.h"
#include "base/random.h"
#include "tools/gusset/training.h"

namespace gusset {
namespace {

// The grid's own values, which win over --config and --set.
std::vector<Assignment> Assignments(const TrainingPlan& plan) {
  std::vector<Assignment> assignments;
  for (const std::string& setting : plan.settings) {
    const std::size_t equals = setting.find('=');
    assignments.push_back({plan.name, setting.substr(0, equals), setting.substr(equals + 1)});
  }
  return assignments;
}

}  // namespace

Settings SimExperimentRig::SettingsOf(const TrainingPlan& plan, int seed) const {
  SettingsSource source{.bag = CellPlan().bag};
  source.assignments = Assignments(plan);
  const auto set = [&](const char* key, const std::string& value) {
    source.assignments.push_back({plan.name, key, value});
  };
  set("train.agent", plan.agent);
  set("train.steps", std::to_string(plan.steps));
  set("train.seed", std::to_string(seed));
  return LoadSettings(common_, source);
}

void SimExperimentRig::CheckSettings(const ExperimentPlan& plan) const {
  for (const TrainingPlan& training : plan.trainings) {
    const Settings settings = SettingsOf(training, 1);
    try {
      (void)MakeAgent(settings);
    } catch (const InputError& e) {
      throw InputError(std::string(e.what()) + "; --agents chooses trainings without it");
    }
  }
}

void SimExperimentRig::Train(const TrainingPlan& plan, int seed,
                             const std::filesystem::path& folder, std::atomic<int>& count,
                             const Stop& stop) {
  const bool begun = Exists(folder / "config.toml");
  TrainInFolder(folder, SettingsOf(plan, seed), begun, 1, stop,
                [&](std::unique_ptr<Environment> environment) {
                  return std::make_unique<CountingEnvironment>(std::move(environment), count);
                });
}

bool SimExperimentRig::HasTrained(const TrainingPlan& plan, int seed,
                                  const std::filesystem::path& folder) {
  if (!Exists(folder / "policy.json")) return false;
  (void)OpenRun(folder, SettingsOf(plan, seed));
  return HasPictures(folder);
}

ExperimentRig::Subject SimExperimentRig::Open(const TrainingPlan& plan, const CellPlan& cell,
                                              const std::filesystem::path& folder) {
  const Settings settings = LoadSettings(common_, {.base = RunFolder::Open(folder).config(),
                                                   .bag = cell.bag,
                                                   .assignments = Assignments(plan)});
  Subject subject;
  subject.agent = LoadAgent(folder.string(), settings);
  subject.environments = settings.EnvironmentFactory();
  subject.versions = Versions(settings);
  static const std::uint64_t program = DeriveSeed(0, ReadFile("/proc/self/exe"));
  subject.actor = settings.resolved + std::to_string(program);
  return subject;
}

}  // namespace gusset
