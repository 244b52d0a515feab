#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/environment.h"
#include "agents/experiment/plan.h"
#include "agents/experiment/result_set.h"
#include "agents/workers.h"

namespace gusset {

/// Counts the actions of an environment, so that whoever waits can be told how it goes.
class CountingEnvironment final : public Environment {
 public:
  CountingEnvironment(std::unique_ptr<Environment> environment, std::atomic<int>& count)
      : environment_(std::move(environment)), count_(count) {}
  std::vector<int> ActionCounts() const override { return environment_->ActionCounts(); }
  Snapshot Start(StartKind kind, std::uint64_t seed) override {
    return environment_->Start(kind, seed);
  }
  Percept Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) override {
    return environment_->Begin(snapshot, sensor_seed);
  }
  Outcome Act(int action) override {
    ++count_;
    return environment_->Act(action);
  }
  FrameWriter Frames() const override { return environment_->Frames(); }

 private:
  std::unique_ptr<Environment> environment_;
  std::atomic<int>& count_;
};

/// What an experiment needs of the world; called from several threads at once.
class ExperimentRig {
 public:
  /// A policy and the worlds to try it in.
  struct Subject {
    std::unique_ptr<Agent> agent;
    Workers::Factory environments;
    nlohmann::json versions;
    std::string actor;  ///< Program and config, in whatever words (JournalEnvironment).
  };
  using Stop = std::function<bool()>;

  virtual ~ExperimentRig() = default;
  /// Makes `folder` an ordinary run folder with a policy: trains, or continues what is there.
  /// @param count  goes up by one with every action. @throws InputError, RunError as Train does.
  virtual void Train(const TrainingPlan& plan, int seed, const std::filesystem::path& folder,
                     std::atomic<int>& count, const Stop& stop) = 0;
  /// Whether the training in `folder` has ended, its pictures included.
  /// @throws InputError if it has, and is not the one planned.
  virtual bool HasTrained(const TrainingPlan& plan, int seed,
                          const std::filesystem::path& folder) = 0;
  /// The finished training in `folder` and what its policy is to be tried in.
  virtual Subject Open(const TrainingPlan& plan, const CellPlan& cell,
                       const std::filesystem::path& folder) = 0;
};

/// How far an experiment is.
struct ExperimentProgress {
  int units_done = 0, units = 0;  ///< Trainings and trials, those found finished included.
  int actions = 0;                ///< Done in this process.
  double actions_left = 0;        ///< Estimated.
  double seconds = 0;             ///< Since the start of this process's work.
  std::string finished;           ///< What has just been finished, or failed; else empty.

  double actions_per_s() const { return seconds > 0 ? actions / seconds : 0; }
  /// Estimate; 0 if no action is done yet.
  double seconds_left() const { return actions > 0 ? actions_left / actions_per_s() : 0; }
};

/// What an experiment came to.
struct ExperimentResult {
  std::vector<ResultRow> rows;
  std::vector<std::string> failed;  ///< "pi10 seed 3: why", one line each.
};

/// Runs what the plan needs and is not finished in `context.out`, `jobs` units at once, and keeps
/// results.csv up to date after each. Units are whole trainings and trials and do not depend on
/// each other but for a trial on its training; so the result does not depend on `jobs` or on what
/// was interrupted. A unit that cannot be finished is left out, and those that need it.
///
///   results.csv                 the result set; rows that are not in the plan stay in it
///   trainings/NAME-seedN/       run folders
///   trials/CELL-seedN/*.json    folded, unfolded, attempts; *.journal/ of those not finished: what
///                               their actions led to, so that no action is done twice
///
/// @param report  called on the caller's thread, about once a second and after each unit.
/// @throws InputError if something in the folder is not of this plan or its results.csv none,
/// RunError if `stop` becomes true.
ExperimentResult RunExperiment(const ExperimentPlan& plan, const ExperimentOptions& options,
                               const Published& published, const ResultContext& context,
                               ExperimentRig& rig, int jobs, const std::function<bool()>& stop,
                               const std::function<void(const ExperimentProgress&)>& report);

/// How many actions the plan will take, about.
double ExpectedActions(const ExperimentPlan& plan, const ExperimentOptions& options);

}  // namespace gusset
