#include <cstdio>

#include "agents/json_fields.h"
#include "base/error.h"
#include "base/files.h"
#include "tools/gusset/command.h"
#include "tools/gusset/result_file.h"
#include "tools/gusset/settings.h"
#ifdef GUSSET_HAS_BENCH
#include "tools/gusset/bench/suite.h"
#endif

namespace gusset {
namespace {

struct FigureHelp {
  const char* name;
  const char* unit;
  const char* what;
};

constexpr FigureHelp kFigures[] = {
    {"rtf_awake", "x real time", "physics of a moving bag; the slower of two scenes"},
    {"rtf_action", "x real time", "whole actions, looks included"},
    {"vs_bt_deformable", "x", "speed against Bullet's own deformable solver, same scene"},
    {"growth_exponent", "", "p in time per substep ~ nodes^p, 500 to 8,000 nodes"},
    {"action_ms", "ms", "one action, median"},
    {"train_s", "s", "training, 100 steps per state, two cores, no start made before"},
    {"two_core_speedup", "x", "two worlds on two cores against one on one"},
    {"world_mb", "MB", "memory of a further world"},
    {"frame_ms", "ms", "one overhead frame, colour and depth with sensor noise"},
    {"perception_ms", "ms", "state, areas and pose points from a frame"},
    {"nodes", "", "of the bag"}};

class BenchCommand final : public Command {
 public:
  const char* name() const override { return "bench"; }
  const char* summary() const override {
    return "Measure speeds, as ratios against the stock solver, in one run";
  }

  void Declare(CLI::App& app) override {
    std::vector<std::string> names;
    for (const FigureHelp& figure : kFigures) names.push_back(figure.name);
    app.add_option("--only", only_, "Measure these figures and what comes with them")
        ->check(CLI::IsMember(names))
        ->type_name("NAME...");
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file [bag1]");
    app.add_option("--out", out_, "Write the JSON document to this file too")->type_name("FILE");
    app.add_flag("--quick", quick_, "Fewer repetitions, and no training");
    app.add_flag("--json", json_, "Print one JSON document");
    common_.AddTo(app);
  }

#ifdef GUSSET_HAS_BENCH
  void Run() override {
    common_.StartLog();
    if (!out_.empty()) CheckResultFile(out_, "machine");
    const Settings settings = LoadSettings(common_, {.bag = bag_});
    WatchForStop();
    const nlohmann::ordered_json document =
        RunMeasurements({settings, SettingsArguments(), quick_}, only_);
    if (!out_.empty()) WriteFileAtomic(out_, JsonText(document));
    json_ ? PrintJson(document) : PrintTable(document);
  }
#else
  void Run() override {
    throw RunError("bench: this program was built without benchmarks (GUSSET_BUILD_BENCH=OFF)");
  }
#endif

 private:
  std::vector<std::string> SettingsArguments() const {
    std::vector<std::string> arguments;
    if (bag_) arguments.insert(arguments.end(), {"--bag", *bag_});
    for (const std::string& file : common_.config_files) {
      arguments.insert(arguments.end(), {"--config", file});
    }
    for (const std::string& assignment : common_.assignments) {
      arguments.insert(arguments.end(), {"--set", assignment});
    }
    return arguments;
  }

  static void PrintTable(const nlohmann::ordered_json& document) {
    const nlohmann::ordered_json& machine = document["machine"];
    std::printf("%s, %d cores, load %.2f before\n", machine["cpu"].get<std::string>().c_str(),
                machine["cores"].get<int>(), machine["load_before"].get<double>());
    for (const FigureHelp& figure : kFigures) {
      const nlohmann::ordered_json& value = document[figure.name];
      if (value.is_null()) continue;
      std::printf("%-17s %9.4g %-12s %s\n", figure.name, value.get<double>(), figure.unit,
                  figure.what);
    }
  }

  CommonOptions common_;
  std::vector<std::string> only_;
  std::optional<std::string> bag_;
  std::string out_;
  bool quick_ = false;
  bool json_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeBenchCommand() { return std::make_unique<BenchCommand>(); }

}  // namespace gusset
