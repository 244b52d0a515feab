// What one pair of primitives does to the bags that a training left in its state.

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>

#include "agents/replay.h"
#include "agents/run_folder.h"
#include "agents/workers.h"
#include "base/error.h"
#include "base/files.h"
#include "base/random.h"
#include "tests/validation/experiment.h"
#include "tools/gusset/testbed_env.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

constexpr int kMostActions = 8;

struct Trial {
  std::string trace;
  int layers_held = 0, next_state = 0;  // after the action that is asked about
  double reward = 0;
  bool true_success = false;
  bool in_state = false;  // under this noise, too, the camera sees the state
};

class PairsExperiment final : public Command {
 public:
  explicit PairsExperiment(std::string command) : command_(std::move(command)) {}
  const char* name() const override { return "pairs"; }
  const char* summary() const override {
    return "What do actions do to the bags that a training left in their state?";
  }

  void Declare(CLI::App& app) override {
    app.add_option("--run", run_, "Run folder with its checkpoint")->required()->type_name("DIR");
    app.add_option("--state", state_, "0 to 3")->required()->check(CLI::Range(0, 3));
    app.add_option("--actions", actions_, "Each is tried on every bag")->required();
    app.add_option("--bags", bags_, "So many of them, evenly spread over the run")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--seed", seed_, "Of the sensors' noise")->capture_default_str();
    app.add_option("--jobs", jobs_, "Trials at once")->check(CLI::Range(1, 64));
    app.add_flag("--go-on", go_on_, "Then the run's greedy policy, 8 actions in all at most");
    app.add_flag("--trace", trace_, "Print every bag's way");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    const Settings settings = LoadSettings(common_, SourceOf(run_, {}));
    if (go_on_) agent_ = LoadAgent(run_, settings);
    const std::vector<fs::path> worlds = Worlds();
    Workers workers(jobs_, settings.EnvironmentFactory());
    const std::vector<int> on_offer = ActionsOnOffer(settings.bagging.affordances);
    const int most = on_offer.at(static_cast<std::size_t>(state_)) - 1;
    for (const int action : actions_) {
      if (action >= 0 && action <= most) continue;
      throw InputError("--actions: " + std::to_string(action) + " is not within [0, " +
                       std::to_string(most) + "]");
    }
    std::cout << command_ << "\n\n"
              << Row({"action", "bags", "layers held", "next state", "reward", "true successes"})
              << "\n|---|---|---|---|---|---|" << std::endl;
    for (const int action : actions_) {
      std::vector<Trial> trials(worlds.size());
      std::vector<Workers::Task> tasks;
      for (std::size_t i = 0; i < worlds.size(); ++i) {
        tasks.push_back([&, i](Environment& environment) {
          trials[i] = Try(environment, ReadFile(worlds[i]), i, action);
          trials[i].trace = worlds[i].stem().string() + trials[i].trace;
        });
      }
      workers.Run(tasks);
      Print(action, trials);
    }
  }

 private:
  // Snapshots of worlds that were seen in the state and are kept.
  std::vector<fs::path> Worlds() const {
    const RunFolder folder = RunFolder::Open(run_);
    std::vector<fs::path> all;
    for (const nlohmann::json& step : ReadRunSteps(run_)) {
      const fs::path file = folder.SnapshotFile(step.value("step", -1));
      if (step.value("next_state", -1) == state_ && fs::exists(file)) all.push_back(file);
    }
    if (all.empty()) {
      throw InputError(run_ + "/checkpoint: holds no world in s" + std::to_string(state_));
    }
    std::vector<fs::path> picked;
    const std::size_t count = std::min(all.size(), static_cast<std::size_t>(bags_));
    for (std::size_t i = 0; i < count; ++i) picked.push_back(all[i * all.size() / count]);
    return picked;
  }

  Trial Try(Environment& environment, Snapshot world, std::size_t bag, int action) const {
    Trial trial;
    Rng rng(seed_);
    const std::vector<int> n_actions = environment.ActionCounts();
    for (int i = 0; i < (go_on_ ? kMostActions : 1); ++i) {
      const std::uint64_t noise = DeriveSeed(seed_, "pairs", bag * kMostActions + i);
      const Percept seen = environment.Begin(world, noise);
      if (i == 0 && seen.state != state_) return trial;
      const auto state = static_cast<std::size_t>(seen.state);
      if (i > 0) {
        action =
            agent_->Act(seen.state, seen.features, n_actions.at(state), Mode::kGreedy, rng).action;
      }
      Outcome outcome = environment.Act(action);
      const int held = outcome.log.value("layers_held", 0);
      if (i == 0) {
        trial.in_state = true;
        trial.reward = outcome.reward;
        trial.layers_held = held;
        trial.next_state = outcome.next.state;
      }
      const std::string note = outcome.log.value("note", "");
      trial.trace += " s" + std::to_string(seen.state) + ":" + std::to_string(action) + "->s" +
                     std::to_string(outcome.next.state) + " (" + std::to_string(held) +
                     " held, A_o " + Number(outcome.log.value("A_o", 0.0)) +
                     (note.empty() ? ")" : ", " + note + ")");
      trial.true_success = outcome.true_success;
      if (outcome.done) break;
      world = std::move(outcome.after);
    }
    return trial;
  }

  void Print(int action, const std::vector<Trial>& trials) const {
    std::map<int, int> layers, next;
    Readings reward;
    int successes = 0;
    for (const Trial& trial : trials) {
      if (!trial.in_state) continue;
      ++layers[trial.layers_held];
      ++next[trial.next_state];
      reward.Add(trial.reward);
      successes += trial.true_success ? 1 : 0;
    }
    const auto list = [](const std::map<int, int>& counts, const std::string& prefix) {
      std::string text;
      for (const auto& [key, count] : counts) {
        text += (text.empty() ? "" : ", ") + prefix + std::to_string(key) + ": " +
                std::to_string(count);
      }
      return text;
    };
    std::cout << Row({std::to_string(action), std::to_string(reward.count()), list(layers, ""),
                      list(next, "s"), Number(reward.mean(), "%.3f"), std::to_string(successes)})
              << std::endl;
    for (const Trial& trial : trials) {
      if (trace_) std::cerr << trial.trace << (trial.true_success ? " success" : "") << "\n";
    }
  }

  std::string command_;
  CommonOptions common_;
  std::string run_;
  int state_ = 0;
  std::vector<int> actions_;
  int bags_ = 24;
  std::uint64_t seed_ = 1;
  int jobs_ = 1;
  bool go_on_ = false;
  bool trace_ = false;
  std::unique_ptr<Agent> agent_;
};

}  // namespace

std::unique_ptr<Command> MakePairsExperiment(std::string command) {
  return std::make_unique<PairsExperiment>(std::move(command));
}

}  // namespace gusset
