#include <chrono>
#include <cstdio>
#include <iostream>

#include "agents/evaluator.h"
#include "agents/json_fields.h"
#include "agents/report/contact_sheet.h"
#include "agents/report/dumped_action.h"
#include "base/error.h"
#include "base/files.h"
#include "base/stop.h"
#include "tools/gusset/command.h"
#include "tools/gusset/result_file.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/start_option.h"

namespace gusset {
namespace {

class EvaluateCommand final : public Command {
 public:
  const char* name() const override { return "evaluate"; }
  const char* summary() const override { return "Measure how often a policy succeeds"; }

  void Declare(CLI::App& app) override {
    app.add_option("--policy", policy_, "Run folder, policy file, or the word random")->required();
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file [that of the run]");
    start_.AddTo(app);
    app.add_option("--episodes", episodes_, "How many")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--repeats", repeats_, "Actions in one state before an episode is given up")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--seed", seed_, "Seed of starts and noise")
        ->check(SeedRange())
        ->capture_default_str();
    app.add_option("--jobs", jobs_, "Worlds that run at once; the result does not depend on it")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    app.add_option("--out", out_, "Write the JSON document to this file too")->type_name("FILE");
    app.add_option("--dump", dump_,
                   "Of which episodes frames are kept: all, failures, none; beside --out, in FILE "
                   "less its suffix + _frames")
        ->check(CLI::IsMember(DumpChoices()))
        ->capture_default_str();
    app.add_flag("--json", json_, "Print one JSON document");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    if (dump_ != "none" && out_.empty()) {
      throw InputError("--dump " + dump_ + " needs --out, beside which the frames are kept");
    }
    const std::filesystem::path frames =
        std::filesystem::path(out_).replace_extension().concat("_frames");
    if (dump_ != "none") MakeFolder(frames);
    if (!out_.empty()) CheckResultFile(out_, "per_step");
    const SettingsSource source = SourceOf(policy_, bag_);
    const Settings settings = LoadSettings(common_, source);
    const std::vector<std::string> overrides = ChangesBy(common_, source, settings);
    const std::unique_ptr<Agent> agent = LoadAgent(policy_, settings);

    // Also where none are kept: they would lie beside figures that they are not of.
    if (!out_.empty() && IsFolder(frames)) RemoveDumpedActions(frames, "episode");
    WatchForStop();
    const auto start = std::chrono::steady_clock::now();
    Workers workers(jobs_, settings.EnvironmentFactory());
    EvaluationConfig config{
        .start = start_.kind(), .episodes = episodes_, .seed = seed_, .max_repeats = repeats_};
    config.dump = dump_;
    config.frames = frames;
    const auto evaluate = [&] { return Evaluate(workers, *agent, config, StopRequested); };
    const EvaluationResult result =
        dump_ == "none" ? evaluate() : WithContactSheet(config.frames, evaluate);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;

    const nlohmann::ordered_json document = Document(settings, overrides, result, wall.count());
    if (!out_.empty()) WriteFileAtomic(out_, JsonText(document));
    json_ ? PrintJson(document) : PrintTable(result);
  }

 private:
  nlohmann::ordered_json Document(const Settings& settings,
                                  const std::vector<std::string>& overrides,
                                  const EvaluationResult& result, double seconds_wall) const {
    nlohmann::ordered_json per_step = nlohmann::ordered_json::array();
    for (const StateTally& tally : result.per_step) {
      per_step.push_back({{"attempts", tally.attempts},
                          {"successes", tally.successes},
                          {"episodes_reached", tally.reached},
                          {"episodes_passed", tally.passed}});
    }
    const auto ci = WilsonInterval(result.true_successes, episodes_);
    return {{"policy", policy_},
            {"bag", settings.train.bag},
            {"start", start_.start},
            {"pose", start_.pose},
            {"episodes", episodes_},
            {"repeats", repeats_},
            {"overrides", overrides},
            {"true_successes", result.true_successes},
            {"perceived_successes", result.perceived_successes},
            {"success_rate", static_cast<double>(result.true_successes) / episodes_},
            {"ci95", {ci[0], ci[1]}},
            {"per_step", per_step},
            {"disagreements", result.disagreements},
            {"state_disagreements", result.state_disagreements},
            {"seconds_wall", seconds_wall},
            {"seconds_sim", result.seconds_sim},
            {"seed", seed_},
            {"versions", Versions(settings)}};
  }

  void PrintTable(const EvaluationResult& result) const {
    const auto ci = WilsonInterval(result.true_successes, episodes_);
    std::printf("%-24s %-9s %9s %8s %6s  %-12s %8s  %s\n", "policy", "start", "episodes", "success",
                "rate", "95 %", "by eye", "passed s0, s1, s2, s3");
    std::printf("%-24s %-9s %9d %8d %5.0f%%  %3.0f%% - %3.0f%%  %8d ", policy_.c_str(),
                start_.start.c_str(), episodes_, result.true_successes,
                100.0 * result.true_successes / episodes_, 100 * ci[0], 100 * ci[1],
                result.perceived_successes);
    for (const StateTally& tally : result.per_step) {
      std::printf(" %d/%d", tally.passed, tally.reached);
    }
    std::printf("\n");
  }

  CommonOptions common_;
  StartOption start_;
  std::string policy_;
  std::optional<std::string> bag_;
  std::string out_;
  std::string dump_ = "none";
  int episodes_ = 50;
  int repeats_ = EvaluationConfig().max_repeats;
  std::uint64_t seed_ = 7;
  int jobs_ = 1;
  bool json_ = false;
};

}  // namespace

std::unique_ptr<Command> MakeEvaluateCommand() { return std::make_unique<EvaluateCommand>(); }

}  // namespace gusset
