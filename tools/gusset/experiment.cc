#include <cstdio>
#include <iostream>

#include "agents/experiment/commands.h"
#include "agents/experiment/runner.h"
#include "base/config.h"
#include "base/error.h"
#include "base/files.h"
#include "base/stop.h"
#include "tools/gusset/command.h"
#include "tools/gusset/experiment_progress.h"
#include "tools/gusset/experiment_rig.h"
#include "tools/gusset/settings.h"

namespace gusset {
namespace {

class ExperimentCommand final : public Command {
 public:
  const char* name() const override { return "experiment"; }
  const char* summary() const override { return "Repeat a whole series of trainings and trials"; }

  void Declare(CLI::App& app) override {
    app.require_subcommand(1);
    CLI::App& thesis = *app.add_subcommand(
        "thesis",
        "Repeat the thesis's experiments (Tables 5.4 to 5.7, Figure 5.6) beside its own figures");
    thesis.add_option("--out", out_, "Folder for results.csv, trainings/ and trials/")
        ->type_name("DIR")
        ->capture_default_str();
    thesis.add_flag(
        "--resume", resume_,
        "Continue in --out; what is finished there is kept, so more can be added "
        "(a row that is asked for again has the seeds asked for last, once they are done)");
    thesis.add_flag("--list", list_, "Print what would be done, and how many actions it takes");
    thesis.add_flag("--full", options_.full,
                    "Also what the thesis does not have: update rules, other learners, ablations");
    thesis
        .add_option("--only", options_.tables,
                    "Only these tables: " + CLI::detail::join(ExperimentTables(), ", "))
        ->type_name("TABLE");
    thesis.add_option("--agents", options_.agents, "Only these trainings, by name (see --list)")
        ->type_name("NAME");
    const auto number = [&](const char* name, int& value, const char* help) {
      thesis.add_option(name, value, help)->capture_default_str();
    };
    number("--seed", options_.first_seed, "First seed of training");
    number("--seeds", options_.seeds, "How many seeds: that one and those after it");
    number("--episodes", options_.episodes, "Episodes from each start, per policy");
    number("--attempts", options_.attempts, "Attempts at each step, per policy");
    thesis.add_option("--steps", options_.max_steps,
                      "Train for no more steps per state than this, to try the grid out");
    thesis.add_option("--jobs", jobs_, "Trainings and trials at once; results do not depend on it")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    thesis.add_flag("--json", json_, "Print one JSON document instead of tables")
        ->excludes(thesis.get_option("--list"));
    common_.log_level = "warn";
    common_.AddTo(thesis);
  }

  void Run() override {
    common_.StartLog();
    RefuseWhatTheGridSets();
    const ExperimentPlan plan = ThesisPlan(options_);
    if (list_) {
      (void)LoadSettings(common_, {});  // finds mistakes; what a training needs may be missing
      return List(plan);
    }
    SimExperimentRig rig(common_);
    rig.CheckSettings(plan);
    const Published published = Published::Load(AssetsFolder() / "published" / "thesis.toml");
    CheckFolder();
    MakeFolder(out_);
    const FolderLock lock(out_);

    WatchForStop();
    ExperimentResult result;
    {
      ExperimentProgressPrinter progress(common_.log_level == "off");
      result = RunExperiment(plan, options_, published, {out_, MoreArguments()}, rig, jobs_,
                             StopRequested, std::ref(progress));
    }
    if (json_) {
      PrintJson({{"out", out_},
                 {"full", options_.full},
                 {"first_seed", options_.first_seed},
                 {"seeds", options_.seeds},
                 {"episodes", options_.episodes},
                 {"attempts", options_.attempts},
                 {"failed", result.failed},
                 {"rows", ResultJson(result.rows)}});
    } else {
      std::cout << ResultText(result.rows) << "\n"
                << out_ << "/results.csv: every seed, and the "
                << "command that repeats each row" << std::endl;
    }
    if (result.failed.empty()) return;
    throw RunError(
        std::to_string(result.failed.size()) +
        " trainings or trials could not be finished: " + CLI::detail::join(result.failed, "; "));
  }

 private:
  // Values that would be overridden without a word.
  void RefuseWhatTheGridSets() const {
    ConfigTree given;
    common_.ReadInto(given);
    for (const char* own : {"train.agent", "train.bag", "train.steps", "train.seed"}) {
      given.RefuseIfGiven(own, "is the grid's to set; see --agents, --steps, --seed and --only");
    }
  }

  void CheckFolder() const {
    const bool there = Exists(std::filesystem::path(out_) / "results.csv");
    if (there && !resume_) {
      throw InputError(out_ +
                       ": holds an experiment already; continue it with --resume or choose "
                       "another --out");
    }
    if (!there && resume_) {
      throw InputError(out_ + ": holds no experiment to be continued: it has no results.csv");
    }
  }

  // --config and --set as they were given, for the commands in the result set.
  std::string MoreArguments() const {
    std::string more;
    for (const std::string& file : common_.config_files) more += " --config " + ShellWord(file);
    for (const std::string& value : common_.assignments) more += " --set " + ShellWord(value);
    return more;
  }

  void List(const ExperimentPlan& plan) const {
    std::printf("%-28s %-12s %6s  %s\n", "training", "agent", "steps", "settings");
    for (const TrainingPlan& training : plan.trainings) {
      std::printf("%-28s %-12s %6d  %s\n", training.name.c_str(), training.agent.c_str(),
                  training.steps, CLI::detail::join(training.settings, " ").c_str());
    }
    std::printf("\n%-28s %-28s %-6s %s\n", "policy tried in", "training", "bag", "how");
    for (const CellPlan& cell : plan.cells) {
      std::string how = std::to_string(options_.episodes) + " episodes from each start";
      if (cell.attempts) how += ", " + std::to_string(options_.attempts) + " attempts per step";
      if (cell.any_pose) how += ", any pose";
      if (cell.max_repeats != CellPlan().max_repeats) {
        how += ", " + std::to_string(cell.max_repeats) + " action per state";
      }
      std::printf("%-28s %-28s %-6s %s\n", cell.name.c_str(), cell.training.c_str(),
                  cell.bag.c_str(), how.c_str());
    }
    std::printf("\neach with %d seeds, from %d on: about %.0f actions in all\n", options_.seeds,
                options_.first_seed, ExpectedActions(plan, options_));
  }

  CommonOptions common_;
  ExperimentOptions options_;
  std::string out_ = "out/thesis";
  int jobs_ = 1;
  bool resume_ = false;
  bool list_ = false;
  bool json_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeExperimentCommand() { return std::make_unique<ExperimentCommand>(); }

}  // namespace gusset
