#include <spdlog/spdlog.h>
#include <unistd.h>

#include <iostream>

#include "agents/affordances.h"
#include "agents/image_file.h"
#include "agents/plots.h"
#include "agents/replay.h"
#include "agents/report/contact_sheet.h"
#include "base/error.h"
#include "base/files.h"
#include "tools/gusset/command.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/testbed_env.h"

namespace gusset {
namespace {

// @returns the first line of `now` that is not in `then`, for a run that was begun otherwise.
std::string FirstDifference(const std::string& then, const std::string& now) {
  std::istringstream old_lines(then);
  std::istringstream new_lines(now);
  std::string old_line;
  std::string new_line;
  while (std::getline(new_lines, new_line)) {
    if (!std::getline(old_lines, old_line) || old_line != new_line) return new_line;
  }
  return "";
}

// How the mean reward of each state's pose points looks on a bag in that state.
void DrawRewardMaps(const RunFolder& folder, const Settings& settings) {
  const std::vector<LoggedStep> logged = ReadLoggedSteps(folder.steps());
  WriteImage(folder.root() / "curve.png", DrawLearningCurve(logged, kActingStates));

  ConfigTree tree = settings.tree;
  TestbedEnv environment(MakeTestbed(tree), settings.bagging);
  const std::vector<nlohmann::json> steps = ReadRunSteps(folder.root());
  for (int s = 0; s < kActingStates; ++s) {
    int step = 0;
    while (step < static_cast<int>(steps.size()) &&
           steps[static_cast<std::size_t>(step)].at("state") != s)
      ++step;
    if (step == static_cast<int>(steps.size())) continue;
    const Snapshot world = WorldBefore(environment, steps, step);
    environment.Begin(world, steps[static_cast<std::size_t>(step)].at("sensor_seed"));
    WriteImage(
        folder.root() / ("reward_map_s" + std::to_string(s) + ".png"),
        DrawRewardMap(environment.bagging().frame_before().color, environment.bagging().before(),
                      MeanRewards(logged, s, AffordanceOf(s).points)));
  }
}

class TrainCommand final : public Command {
 public:
  const char* name() const override { return "train"; }
  const char* summary() const override { return "Let a learner learn to bag"; }

  void Declare(CLI::App& app) override {
    app.add_option("--out", out_, "Run folder to write")->required()->type_name("DIR");
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file [bag1]");
    const auto option = [&](const char* name, const char* key, const std::string& help) {
      options_.push_back(std::make_unique<Assignment>(Assignment{name, key, {}}));
      app.add_option(name, options_.back()->value, help);
    };
    option("--agent", "train.agent", "Learner: " + CLI::detail::join(AgentNames(), ", ") + " [pi]");
    option("--steps", "train.steps", "Learnt steps per state: 100 means 400 in all [100]");
    option("--seed", "train.seed", "Seed of everything random [1]");
    option("--update", "pi.update", "Update rule: mean, published, last [mean]");
    option("--protocol", "train.protocol", "pools or chain [pools]");
    option("--dump", "train.dump", "Whose frames are kept: all, failures, none [none]");
    app.add_option("--jobs", jobs_, "Worlds that run at once; the result does not depend on it")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    app.add_flag("--resume", resume_, "Continue the run in --out from its last checkpoint");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    SettingsSource source{.bag = bag_};
    for (const auto& option : options_) source.assignments.push_back(*option);
    if (resume_) source.base = RunFolder::Open(out_).config();
    const Settings settings = LoadSettings(common_, source);
    // Before the folder, which would hold a run of an agent that this build does not have.
    const std::unique_ptr<Agent> agent = MakeAgent(settings);
    const RunFolder folder = resume_ ? Reopened(settings) : Created(settings);

    WatchForStop();
    TrainSummary summary;
    {
      Workers workers(jobs_, settings.EnvironmentFactory());
      const nlohmann::ordered_json about = {{"bag", settings.train.bag},
                                            {"protocol", settings.train.protocol},
                                            {"seed", settings.train.seed}};
      const auto train = [&] {
        return Train(workers, *agent, settings.train, folder, about, StopRequested);
      };
      summary = settings.train.dump == "none" ? train() : WithContactSheet(folder.frames(), train);
    }
    DrawRewardMaps(folder, settings);
    std::cout << "trained on " << summary.actions << " actions (" << summary.extra_actions
              << " of them extra), " << std::lround(summary.sim_s / 60)
              << " simulated minutes: " << folder.policy().string() << std::endl;
  }

 private:
  RunFolder Created(const Settings& settings) const {
    char host[256] = "";
    ::gethostname(host, sizeof host - 1);
    ConfigTree tree = settings.tree;
    return RunFolder::Create(out_, settings.resolved,
                             {{"seed", settings.train.seed},
                              {"versions", Versions()},
                              {"renderer", MakeTestbed(tree)->renderer()},
                              {"host", host}});
  }

  RunFolder Reopened(const Settings& settings) const {
    RunFolder folder = RunFolder::Open(out_);
    const std::string difference = FirstDifference(ReadFile(folder.config()), settings.resolved);
    if (!difference.empty()) {
      throw InputError(folder.config().string() + ": the run was begun with another value than " +
                       difference);
    }
    return folder;
  }

  CommonOptions common_;
  std::string out_;
  std::optional<std::string> bag_;
  std::vector<std::unique_ptr<Assignment>> options_;
  int jobs_ = 1;
  bool resume_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeTrainCommand() { return std::make_unique<TrainCommand>(); }

}  // namespace gusset
