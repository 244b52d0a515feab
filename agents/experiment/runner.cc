#include "agents/experiment/runner.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

#include "agents/experiment/commands.h"
#include "agents/experiment/journal.h"
#include "agents/run_folder.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

// Estimates, for the time left alone.
constexpr double kActionsPerFolded = 5;  // of one episode
constexpr double kActionsPerUnfolded = 4;
constexpr double kActionsPerAttempt = 5.5;  // at all four steps, with those that fill pools
constexpr double kPool = 20;                // bags that training fills each of three pools with ...
constexpr double kPerMissing = 5;           // ... in so many actions for each that is missing

struct Unit {
  enum State { kWaiting, kRunning, kFinished, kFailed } state = kWaiting;
  const TrainingPlan* training = nullptr;  // what it trains, or whose policy it tries
  const CellPlan* cell = nullptr;          // nothing: a training
  TrialKind kind = TrialKind::kFolded;
  int seed = 0;
  int after = -1;  // the unit that must be finished first
  double expected = 0;
  std::atomic<int> count = 0;

  std::string Name() const {
    const std::string seeded = " seed " + std::to_string(seed);
    if (cell == nullptr) return training->name + seeded;
    return cell->name + seeded + " " + TrialName(kind);
  }
};

double Expected(const TrainingPlan& plan) {
  return 4.0 * plan.steps + 3 * kPerMissing * std::max(0.0, kPool - plan.steps);
}

double Expected(TrialKind kind, const ExperimentOptions& options) {
  if (kind == TrialKind::kAttempts) return kActionsPerAttempt * options.attempts;
  return options.episodes * (kind == TrialKind::kFolded ? kActionsPerFolded : kActionsPerUnfolded);
}

// In the order of seeds, so that a whole grid of one seed is there early.
std::deque<Unit> MakeUnits(const ExperimentPlan& plan, const ExperimentOptions& options) {
  std::deque<Unit> units;
  for (int i = 0; i < options.seeds; ++i) {
    for (const TrainingPlan& training : plan.trainings) {
      const int number = static_cast<int>(units.size());
      Unit& unit = units.emplace_back();
      unit.training = &training;
      unit.seed = options.first_seed + i;
      unit.expected = Expected(training);
      for (const CellPlan& cell : plan.cells) {
        if (cell.training != training.name) continue;
        for (const TrialKind kind :
             {TrialKind::kFolded, TrialKind::kUnfolded, TrialKind::kAttempts}) {
          if (kind == TrialKind::kAttempts && !cell.attempts) continue;
          Unit& trial = units.emplace_back();
          trial.training = &training;
          trial.cell = &cell;
          trial.kind = kind;
          trial.seed = options.first_seed + i;
          trial.after = number;
          trial.expected = Expected(kind, options);
        }
      }
    }
  }
  return units;
}

class Runner {
 public:
  Runner(const ExperimentPlan& plan, const ExperimentOptions& options, const Published& published,
         const ResultContext& context, ExperimentRig& rig, const std::function<bool()>& stop)
      : plan_(plan),
        options_(options),
        published_(published),
        context_(context),
        rig_(rig),
        user_stop_(stop),
        results_(fs::path(context.out) / "results.csv"),
        units_(MakeUnits(plan, options)) {}

  ExperimentResult Run(int jobs, const std::function<void(const ExperimentProgress&)>& report) {
    if (Exists(results_)) earlier_ = ReadResultLines(results_);
    FindFinished();
    WriteResults();
    begun_ = Clock::now();
    std::vector<std::thread> threads;
    for (int i = 0; i < jobs; ++i) threads.emplace_back([this] { Work(); });
    Watch(jobs, report);
    for (std::thread& thread : threads) thread.join();
    if (fatal_) std::rethrow_exception(fatal_);
    if (user_stop_()) {
      throw RunError("interrupted after " + std::to_string(Count(Unit::kFinished)) + " of " +
                     std::to_string(units_.size()) + " trainings and trials; " + context_.out +
                     " can be continued with --resume");
    }
    return {Rows(), failed_};
  }

 private:
  fs::path FolderOf(const Unit& unit) const {
    return fs::path(context_.out) / TrainingFolder(unit.training->name, unit.seed);
  }
  fs::path FileOf(const Unit& unit) const {
    return fs::path(context_.out) / "trials" /
           (unit.cell->name + "-seed" + std::to_string(unit.seed)) /
           (std::string(TrialName(unit.kind)) + ".json");
  }
  fs::path JournalOf(const Unit& unit) const { return FileOf(unit).replace_extension("journal"); }
  TrialPlan TrialOf(const Unit& unit) const {
    return {*unit.cell, unit.kind, unit.seed,
            unit.kind == TrialKind::kAttempts ? options_.attempts : options_.episodes};
  }

  // What an earlier process left.
  void FindFinished() {
    for (Unit& unit : units_) {
      if (unit.cell == nullptr) {
        if (!rig_.HasTrained(*unit.training, unit.seed, FolderOf(unit))) continue;
        Keep(unit, ReadTrainingResult(FolderOf(unit)));
      } else if (units_[static_cast<std::size_t>(unit.after)].state == Unit::kFinished) {
        if (auto record = ReadTrial(FileOf(unit), TrialOf(unit))) Keep(unit, std::move(*record));
      }
    }
  }

  void Keep(Unit& unit, TrainingResult result) {
    finished_.trainings[{unit.training->name, unit.seed}] = std::move(result);
    unit.state = Unit::kFinished;
  }
  void Keep(Unit& unit, TrialRecord record) {
    finished_.trials[{unit.cell->name, unit.kind, unit.seed}] = std::move(record);
    unit.state = Unit::kFinished;
  }

  bool Stop() const { return abandoned_ || user_stop_(); }

  // ---- on the workers' threads

  void Work() {
    std::unique_lock lock(mutex_);
    while (Unit* unit = Next(lock)) {
      unit->state = Unit::kRunning;
      lock.unlock();
      std::exception_ptr error;
      TrainingResult training;
      TrialRecord trial;
      try {
        unit->cell == nullptr ? Train(*unit, training) : Try(*unit, trial);
      } catch (...) {
        error = std::current_exception();
      }
      lock.lock();
      if (error) {
        Fail(*unit, error);
      } else {
        unit->cell == nullptr ? Keep(*unit, std::move(training)) : Keep(*unit, std::move(trial));
        events_.push_back(unit->Name() + Ending(*unit));
      }
      Guarded([&] { WriteResults(); });
      changed_.notify_all();
    }
    ++idle_;
    changed_.notify_all();
  }

  // The first unit that can be begun; waits for one. @returns nullptr if there will be none.
  Unit* Next(std::unique_lock<std::mutex>& lock) {
    for (;;) {
      if (Stop()) return nullptr;
      bool later = false;
      for (Unit& unit : units_) {
        if (unit.state != Unit::kWaiting) continue;
        if (unit.after < 0) return &unit;
        const Unit& before = units_[static_cast<std::size_t>(unit.after)];
        if (before.state == Unit::kFinished) return &unit;
        if (before.state == Unit::kFailed) unit.state = Unit::kFailed;
        later = later || before.state != Unit::kFailed;
      }
      if (!later) return nullptr;
      changed_.wait_for(lock, std::chrono::milliseconds(200));
    }
  }

  // What was tried with an earlier training of that name and seed says nothing of this one.
  void DropTrials(const Unit& training) const {
    for (const Unit& unit : units_) {
      if (unit.cell == nullptr || &units_[static_cast<std::size_t>(unit.after)] != &training)
        continue;
      std::error_code ignored;  // there may be none
      fs::remove(FileOf(unit), ignored);
    }
  }

  void Train(Unit& unit, TrainingResult& result) {
    if (!IsFolder(FolderOf(unit))) DropTrials(unit);
    rig_.Train(*unit.training, unit.seed, FolderOf(unit), unit.count, [this] { return Stop(); });
    result = ReadTrainingResult(FolderOf(unit));
  }

  void Try(Unit& unit, TrialRecord& record) {
    ExperimentRig::Subject subject = rig_.Open(*unit.training, *unit.cell, FolderOf(unit));
    const fs::path journal = JournalOf(unit);
    Workers workers(1, [&] {
      return std::make_unique<JournalEnvironment>(
          std::make_unique<CountingEnvironment>(subject.environments(), unit.count), journal,
          subject.actor);
    });
    record = RunTrial(workers, *subject.agent, TrialOf(unit), [this] { return Stop(); });
    record.versions = subject.versions;
    MakeFolder(FileOf(unit).parent_path());
    WriteTrial(FileOf(unit), TrialOf(unit), record);
    std::error_code ignored;  // it is of no more use, and does no harm
    fs::remove_all(journal, ignored);
  }

  std::string Ending(const Unit& unit) const {
    if (unit.cell == nullptr) {
      const TrainingResult& result = finished_.trainings.at({unit.training->name, unit.seed});
      return ": trained, " + std::to_string(result.actions) + " actions";
    }
    const TrialRecord& record = finished_.trials.at({unit.cell->name, unit.kind, unit.seed});
    std::string text = ":";
    for (std::size_t i = 0; i < record.n.size(); ++i) {
      text += (i == 0 ? " " : ", ") + std::to_string(record.successes[i]) + " of " +
              std::to_string(record.n[i]);
    }
    return text;
  }

  // A run that cannot be finished is that unit's affair; anything else is everyone's.
  void Fail(Unit& unit, const std::exception_ptr& error) {
    unit.state = Unit::kFailed;
    if (Stop()) return;
    try {
      std::rethrow_exception(error);
    } catch (const RunError& e) {
      if (unit.cell == nullptr) {
        finished_.failed_trainings.insert({unit.training->name, unit.seed});
      } else {
        finished_.failed_trials.insert({unit.cell->name, unit.kind, unit.seed});
      }
      failed_.push_back(unit.Name() + ": " + e.what());
      events_.push_back("FAILED " + failed_.back());
    } catch (...) {
      Abandon(error);
    }
  }

  template <class Action>
  void Guarded(const Action& action) {
    try {
      action();
    } catch (...) {
      Abandon(std::current_exception());
    }
  }

  void Abandon(const std::exception_ptr& error) {
    if (!fatal_) fatal_ = error;
    abandoned_ = true;
  }

  // ---- on the caller's thread

  void Watch(int jobs, const std::function<void(const ExperimentProgress&)>& report) {
    std::unique_lock lock(mutex_);
    for (;;) {
      const bool over = idle_ == jobs;
      std::deque<std::string> events;
      events.swap(events_);
      const ExperimentProgress progress = Progress();
      lock.unlock();
      for (const std::string& event : events) {
        ExperimentProgress with = progress;
        with.finished = event;
        report(with);
      }
      if (events.empty()) report(progress);
      lock.lock();
      if (over && events_.empty()) return;
      if (idle_ == jobs || !events_.empty()) continue;
      changed_.wait_for(lock, std::chrono::seconds(1));
    }
  }

  ExperimentProgress Progress() const {
    ExperimentProgress progress;
    progress.units = static_cast<int>(units_.size());
    progress.units_done = Count(Unit::kFinished);
    for (const Unit& unit : units_) {
      progress.actions += unit.count;
      if (unit.state == Unit::kWaiting) progress.actions_left += unit.expected;
      if (unit.state == Unit::kRunning) {
        progress.actions_left += std::max(0.0, unit.expected - unit.count);
      }
    }
    progress.seconds = std::chrono::duration<double>(Clock::now() - begun_).count();
    return progress;
  }

  int Count(Unit::State state) const {
    return static_cast<int>(
        std::ranges::count_if(units_, [&](const Unit& unit) { return unit.state == state; }));
  }

  std::vector<ResultRow> Rows() const {
    return MakeResultRows(plan_, options_, finished_, published_, context_);
  }
  void WriteResults() const {
    const std::vector<ResultRow> rows = Rows();
    const bool finished = Count(Unit::kFinished) == static_cast<int>(units_.size());
    WriteFileAtomic(results_, ResultCsv(rows, OtherLines(earlier_, plan_, rows, finished)));
  }

  const ExperimentPlan& plan_;
  const ExperimentOptions& options_;
  const Published& published_;
  const ResultContext& context_;
  ExperimentRig& rig_;
  const std::function<bool()>& user_stop_;
  const fs::path results_;
  std::vector<CsvRecord> earlier_;  // that results.csv had before
  std::atomic<bool> abandoned_ = false;

  mutable std::mutex mutex_;  // of all below, but for the units' counts
  std::condition_variable changed_;
  std::deque<Unit> units_;
  Finished finished_;
  std::vector<std::string> failed_;
  std::deque<std::string> events_;  // not yet reported
  std::exception_ptr fatal_;
  int idle_ = 0;  // threads that have nothing left to do
  Clock::time_point begun_;
};

}  // namespace

ExperimentResult RunExperiment(const ExperimentPlan& plan, const ExperimentOptions& options,
                               const Published& published, const ResultContext& context,
                               ExperimentRig& rig, int jobs, const std::function<bool()>& stop,
                               const std::function<void(const ExperimentProgress&)>& report) {
  MakeFolder(context.out);
  return Runner(plan, options, published, context, rig, stop).Run(jobs, report);
}

double ExpectedActions(const ExperimentPlan& plan, const ExperimentOptions& options) {
  double sum = 0;
  for (const Unit& unit : MakeUnits(plan, options)) sum += unit.expected;
  return sum;
}

}  // namespace gusset
