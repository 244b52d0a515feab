#include <cmath>
#include <iostream>

#include "agents/run_folder.h"
#include "base/stop.h"
#include "tools/gusset/command.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/training.h"

namespace gusset {
namespace {

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

    WatchForStop();
    const TrainSummary summary = TrainInFolder(out_, settings, resume_, jobs_, StopRequested);
    std::cout << "trained on " << summary.actions << " actions (" << summary.extra_actions
              << " of them extra), " << std::lround(summary.sim_s / 60)
              << " simulated minutes: " << PolicyFile(out_).string() << std::endl;
  }

 private:
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
