#include <iostream>

#include "base/error.h"
#include "base/random.h"
#include "tests/validation/experiment.h"

namespace gusset {
namespace {

struct Setting {
  const char* name;
  std::vector<std::string> assignments;
};

// The first is what the others are compared with.
const std::vector<Setting>& Ladder() {
  static const std::vector<Setting> settings = {
      {"as the bag's file and the defaults have it", {}},
      {"16 x 18 nodes", {"bag.nodes_across=16", "bag.nodes_deep=18"}},
      {"22 x 25 nodes", {"bag.nodes_across=22", "bag.nodes_deep=25"}},
      {"31 x 36 nodes", {"bag.nodes_across=31", "bag.nodes_deep=36"}},
      {"300 substeps/s", {"solver.substeps_per_s=300"}},
      {"600 substeps/s", {"solver.substeps_per_s=600"}},
      {"1200 substeps/s", {"solver.substeps_per_s=1200"}},
  };
  return settings;
}

struct Result {
  int nodes = 0, substeps_per_s = 0, stopped = 0;
  Readings A_bag, A_o;
};

// What grasp + lift makes of folded bags and scratch + drag of flat ones, at other meshes and
// substeps: the same seeds and actions, so that a shift between rows is the setting's.
class RefinementExperiment final : public Command {
 public:
  explicit RefinementExperiment(std::string command) : command_(std::move(command)) {}
  const char* name() const override { return "refinement"; }
  const char* summary() const override {
    return "Outcomes of unfolding and opening at finer meshes and other substeps";
  }

  void Declare(CLI::App& app) override {
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file")
        ->capture_default_str();
    app.add_option("--actions", actions_, "Of each kind, at each setting")
        ->check(CLI::Range(2, 100000))
        ->capture_default_str();
    app.add_option("--seed", seed_, "Seed of starts, actions and noise")->capture_default_str();
    app.add_option("--only", only_, "Rows to measure, by number; the first (1) always is")
        ->check(CLI::Range(1, static_cast<int>(Ladder().size())));
    common_.AddTo(app);
  }

  void Run() override {
    std::cout
        << "`" << command_ << "`\n\n"
        << "| setting | nodes | substeps/s | A_bag after grasp + lift: mean, deviation (px^2) "
           "| shift of the mean | in deviations | A_o after scratch + drag: mean, deviation "
           "(px^2) | shift of the mean | in deviations | worlds stopped |\n"
        << "|---|---|---|---|---|---|---|---|---|---|" << std::endl;
    std::optional<Result> reference;
    std::string resolved;
    for (std::size_t k = 0; k < Ladder().size(); ++k) {
      const int row = static_cast<int>(k) + 1;
      if (k > 0 && !only_.empty() && std::ranges::find(only_, row) == only_.end()) continue;
      const Setting& setting = Ladder()[k];
      CommonOptions common = common_;
      common.assignments.insert(common.assignments.end(), setting.assignments.begin(),
                                setting.assignments.end());
      const Settings settings = LoadSettings(common, {.bag = bag_});
      // What the first row is already.
      if (settings.resolved == resolved) continue;
      if (k == 0) resolved = settings.resolved;
      const Result result = Measure(settings);
      if (!reference) reference = result;
      Print(setting.name, result, *reference);
    }
  }

 private:
  Result Measure(const Settings& settings) const {
    Rig rig(settings);
    Result result;
    result.nodes = rig.scene.world().cloth().mesh().node_count();
    result.substeps_per_s = rig.scene.config().solver.substeps_per_s;
    const std::vector<int> n_actions = rig.env.ActionCounts();
    for (int state = 0; state < 2; ++state) {
      const StartKind kind = state == 0 ? StartKind::kFolded : StartKind::kUnfolded;
      for (int i = 0; i < actions_; ++i) {
        const auto index = static_cast<std::uint64_t>(i);
        const Snapshot start = rig.env.Start(kind, DeriveSeed(seed_, "refinement start", index));
        // A start that perception takes for another state affords other actions.
        if (rig.env.Begin(start, DeriveSeed(seed_, "refinement sensors", index)).state != state) {
          continue;
        }
        Rng rng(DeriveSeed(seed_, "refinement action", index));
        try {
          (void)rig.env.Act(rng.Below(n_actions[static_cast<std::size_t>(state)]));
        } catch (const RunError& e) {
          ++result.stopped;
          std::cerr << e.what() << std::endl;
          continue;
        }
        const Observation& after = rig.env.after();
        state == 0 ? result.A_bag.Add(after.A_bag) : result.A_o.Add(after.A_o);
      }
    }
    return result;
  }

  static void Print(const char* name, const Result& result, const Result& reference) {
    const auto spread = [](const Readings& s) {
      return Number(s.mean(), "%.0f") + " +- " + Number(s.error(), "%.0f") + ", " +
             Number(s.deviation(), "%.0f") + " (" + std::to_string(s.count()) + ")";
    };
    const auto shift = [](const Readings& s, const Readings& from) {
      return s.mean() - from.mean();
    };
    const auto in_deviations = [&](const Readings& s, const Readings& from) {
      return from.deviation() > 0 ? Number(shift(s, from) / from.deviation(), "%+.2f")
                                  : std::string("-");
    };
    std::cout << Row({name, std::to_string(result.nodes), std::to_string(result.substeps_per_s),
                      spread(result.A_bag), Number(shift(result.A_bag, reference.A_bag), "%+.0f"),
                      in_deviations(result.A_bag, reference.A_bag), spread(result.A_o),
                      Number(shift(result.A_o, reference.A_o), "%+.0f"),
                      in_deviations(result.A_o, reference.A_o), std::to_string(result.stopped)})
              << std::endl;
  }

  std::string command_;
  CommonOptions common_;
  std::string bag_ = "bag1";
  int actions_ = 200;
  std::uint64_t seed_ = 1;
  std::vector<int> only_;
};

}  // namespace

std::unique_ptr<Command> MakeRefinementExperiment(std::string command) {
  return std::make_unique<RefinementExperiment>(std::move(command));
}

}  // namespace gusset
