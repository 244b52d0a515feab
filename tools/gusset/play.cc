#include <cstdio>
#include <iostream>

#include "agents/affordances.h"
#include "agents/evaluator.h"
#include "agents/json_fields.h"
#include "agents/replay.h"
#include "agents/report/contact_sheet.h"
#include "agents/report/dumped_action.h"
#include "agents/run_folder.h"
#include "base/error.h"
#include "base/files.h"
#include "tools/gusset/command.h"
#include "tools/gusset/episode_video.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/start_option.h"

namespace gusset {
namespace {

std::string Caption(const BaggingConfig& config, int state, int action) {
  const int pair = config.affordances ? state : PairOfAction(action, action);
  const Affordance& rule = AffordanceOf(pair);
  const ActionChoice choice = DecodeAction(pair, action);
  return "s" + std::to_string(state) + ": " + rule.primary + " + " + rule.complementary +
         ", point " + std::to_string(choice.point) + ", parameter " +
         std::to_string(choice.parameter);
}

// An agent whose choices are told to someone before they are carried out.
class Announced final : public Agent {
 public:
  Announced(const Agent& agent, const BaggingConfig& config, EpisodeVideo& video)
      : agent_(agent), config_(config), video_(video) {}
  Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
               Rng& rng) const override {
    const Decision decision = agent_.Act(state, features, n_actions, mode, rng);
    video_.Say(Caption(config_, state, decision.action));
    return decision;
  }
  void Learn(const Transition&) override {}
  nlohmann::json Save() const override { return agent_.Save(); }
  void Load(const nlohmann::json&) override {}
  std::string name() const override { return agent_.name(); }

 private:
  const Agent& agent_;
  const BaggingConfig& config_;
  EpisodeVideo& video_;
};

constexpr const char* kFrames = "action";  // what their names begin with
constexpr const char* kEpisodeFilm = "episode.mp4";
constexpr const char* kActionFilm = "action.mp4";
constexpr const char* kEpisode = "episode.json";

class PlayCommand final : public Command {
 public:
  const char* name() const override { return "play"; }
  const char* summary() const override {
    return "One episode, or one logged action again, with every frame, overlay and a video";
  }

  void Declare(CLI::App& app) override {
    CLI::Option* policy =
        app.add_option("--policy", policy_, "Run folder, policy file, or the word random");
    CLI::Option* run = app.add_option("--run", run_, "Run folder of which to repeat an action");
    app.add_option("--step", step_, "Which action of --run")->needs(run)->excludes(policy);
    run->excludes(policy);
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file [that of the run]");
    start_.AddTo(app);
    for (const char* of_episode : {"--start", "--pose"}) app.get_option(of_episode)->excludes(run);
    app.add_option("--seed", seed_, "Seed of the episode")
        ->check(SeedRange())
        ->capture_default_str();
    app.add_option("--out", out_, "Folder for the pictures")->required()->type_name("DIR");
    app.add_option("--dump", dump_, "Whose frames are kept, beside the video: all, failures, none")
        ->check(CLI::IsMember(DumpChoices()))
        ->capture_default_str();
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    if (policy_.empty() == run_.empty()) throw InputError("play needs either --policy or --run");
    if (!run_.empty()) steps_ = ReadRunSteps(run_);
    Settings settings = LoadSettings(
        common_, run_.empty()
                     ? SourceOf(policy_, bag_)
                     : SettingsSource{.base = RunFolder::Open(run_).config(), .bag = bag_});
    // Before the folder, which would be left empty by a policy that is none.
    const std::unique_ptr<Agent> agent = run_.empty() ? LoadAgent(policy_, settings) : nullptr;
    MakeFolder(out_);
    TestbedEnv environment(MakeTestbed(settings.tree), settings.bagging);
    environment.ShowFromTheSide();
    agent ? PlayEpisode(settings, *agent, environment) : RepeatStep(settings, environment);
    if (dump_ != "none") WriteContactSheet(out_);
  }

 private:
  // What an earlier play left would be taken for a part of this one.
  void ClearFolder(const char* other_film) const {
    RemoveDumpedActions(out_, kFrames);
    for (const char* name : {other_film, kEpisode}) {
      std::filesystem::remove(std::filesystem::path(out_) / name);
    }
  }

  void PlayEpisode(const Settings& settings, const Agent& agent, TestbedEnv& environment) const {
    Episode episode;
    EpisodeFrames frames(dump_, std::filesystem::path(out_) / kFrames);
    {
      EpisodeVideo video(std::filesystem::path(out_) / kEpisodeFilm, environment);
      ClearFolder(kActionFilm);
      episode = RunEpisode(environment, Announced(agent, settings.bagging, video),
                           {.start = start_.kind(), .episodes = 1, .seed = seed_}, 0, &frames);
      video.Finish();
    }
    frames.Finish(episode.true_success);
    nlohmann::ordered_json steps = nlohmann::ordered_json::array();
    for (const Episode::Step& step : episode.steps) {
      steps.push_back({{"state", step.state},
                       {"action", step.action},
                       {"next_state", step.next_state},
                       {"next_state_true", step.true_state},
                       {"sensor_seed", step.sensor_seed}});
      std::cout << Caption(settings.bagging, step.state, step.action) << " -> s" << step.next_state
                << "\n";
    }
    std::cout << (episode.true_success ? "success" : "failure") << ", seen as "
              << (episode.perceived_success ? "success" : "failure") << ": " << out_ << std::endl;
    const nlohmann::ordered_json document = {{"policy", policy_},
                                             {"seed", seed_},
                                             {"start", start_.start},
                                             {"start_seed", episode.start_seed},
                                             {"true_success", episode.true_success},
                                             {"perceived_success", episode.perceived_success},
                                             {"steps", steps}};
    WriteFileAtomic(std::filesystem::path(out_) / kEpisode, JsonText(document));
  }

  /// A number of the step to repeat. @throws InputError naming file and line.
  int Logged(const char* field, int least, int most) const {
    try {
      return JsonField<int>(steps_.at(static_cast<std::size_t>(step_)), field, least, most);
    } catch (const InputError& e) {
      throw InputError(run_ + "/steps.jsonl:" + std::to_string(step_ + 1) + ": " + e.what());
    }
  }

  void RepeatStep(const Settings& settings, TestbedEnv& environment) const {
    if (step_ < 0 || step_ >= static_cast<int>(steps_.size())) {
      throw InputError("--step " + std::to_string(step_) + ": " + run_ + " has " +
                       std::to_string(steps_.size()) + " steps, from 0 on");
    }
    // Before the world, which takes as long as all that led to it.
    const int state = Logged("state", 0, kActingStates - 1);
    const int on_offer = environment.ActionCounts().at(static_cast<std::size_t>(state));
    const int action = Logged("action", 0, on_offer - 1);
    const Snapshot world = WorldBefore(environment, steps_, step_);
    const nlohmann::json& line = steps_.at(static_cast<std::size_t>(step_));
    const Percept percept = environment.Begin(world, JsonField<std::uint64_t>(line, "sensor_seed"));
    if (percept.state != state) {
      throw RunError("step " + std::to_string(step_) +
                     " does not come out as logged: the bag is in s" +
                     std::to_string(percept.state));
    }
    const std::string caption = Caption(settings.bagging, percept.state, action);
    EpisodeVideo video(std::filesystem::path(out_) / kActionFilm, environment);
    ClearFolder(kEpisodeFilm);
    video.Say(caption);
    const Outcome outcome = environment.Act(action);
    video.Finish();
    if (dump_ == "all" || (dump_ == "failures" && ActionFailed(percept.state, outcome))) {
      char name[32];
      std::snprintf(name, sizeof name, "%s%02d", kFrames, step_);
      nlohmann::ordered_json about = line;
      about["reward"] = outcome.reward;
      about["next_state"] = outcome.next.state;
      about["next_state_true"] = outcome.truth.state;
      environment.Frames()(std::filesystem::path(out_) / name, about);
    }
    std::cout << caption << " -> s" << outcome.next.state << ", reward " << outcome.reward
              << " (logged: " << line.value("reward", 0.0) << "): " << out_ << std::endl;
  }

  CommonOptions common_;
  StartOption start_;
  std::string policy_;
  std::string run_;
  std::vector<nlohmann::json> steps_;  // of run_
  int step_ = 0;
  std::optional<std::string> bag_;
  std::uint64_t seed_ = 3;
  std::string out_;
  std::string dump_ = "all";
};

}  // namespace

std::unique_ptr<Command> MakePlayCommand() { return std::make_unique<PlayCommand>(); }

}  // namespace gusset
