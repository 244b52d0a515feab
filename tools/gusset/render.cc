#include <spdlog/spdlog.h>

#include <cstdio>
#include <iostream>

#include "agents/image_file.h"
#include "base/error.h"
#include "base/files.h"
#include "perception/overlay.h"
#include "tools/gusset/command.h"
#include "tools/gusset/settings.h"
#include "tools/gusset/testbed_env.h"

namespace gusset {
namespace {

// Actions per episode, and episodes per frame asked for, before render gives up.
constexpr int kActions = 12;
constexpr int kEpisodesPerFrame = 100;

nlohmann::ordered_json CameraJson(const CameraModel& camera) {
  const Pinhole& k = camera.pinhole;
  nlohmann::ordered_json X_WC = nlohmann::ordered_json::array();
  for (int row = 0; row < 4; ++row) {
    nlohmann::ordered_json values = nlohmann::ordered_json::array();
    for (int column = 0; column < 4; ++column) values.push_back(camera.X_WC.matrix()(row, column));
    X_WC.push_back(values);
  }
  return {{"K", {{k.fx, 0, k.cx}, {0, k.fy, k.cy}, {0, 0, 1}}},
          {"width", k.width},
          {"height", k.height},
          {"X_WC", X_WC},
          {"depth_scale_m", 0.001}};
}

// Labelled frames: worlds reached by physics, from the starts and by the actions of a policy, kept
// when ground truth says that the state is the one asked for.
class RenderCommand final : public Command {
 public:
  const char* name() const override { return "render"; }
  const char* summary() const override { return "Write labelled frames of one state"; }

  void Declare(CLI::App& app) override {
    app.add_option("--state", state_, "s0 to s5, by ground truth")
        ->required()
        ->check(CLI::IsMember({"s0", "s1", "s2", "s3", "s4", "s5"}));
    app.add_option("--count", count_, "How many")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--seed", seed_, "Seed of starts, actions and noise")->capture_default_str();
    app.add_option("--out", out_, "Folder to write")->required()->type_name("DIR");
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file [bag1]");
    app.add_option("--policy", policy_, "Who acts on the way to the state")->capture_default_str();
    app.add_flag("--vary", vary_,
                 "Vary light, camera, colours, labels and clutter: variation.amount = 1");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    const std::filesystem::path base = policy_ == "random" ? "" : ConfigBeside(policy_);
    Settings settings = LoadSettings(
        common_, {.base = base,
                  .bag = bag_,
                  .assignments = {{"--vary", "variation.amount",
                                   vary_ ? std::optional<std::string>("1") : std::nullopt}}});
    const std::unique_ptr<Agent> agent = LoadAgent(policy_, settings);
    MakeFolder(out_);
    LineLog labels(std::filesystem::path(out_) / "labels.jsonl");
    TestbedEnv environment(MakeTestbed(settings.tree), settings.bagging);
    WriteFileAtomic(std::filesystem::path(out_) / "camera.json",
                    CameraJson(environment.testbed().camera().model()).dump(2) + "\n");
    WatchForStop();
    for (int episode = 0; written_ < count_; ++episode) {
      if (episode == kEpisodesPerFrame * count_) {
        throw RunError(std::to_string(written_) + " frames of " + state_ + " in " +
                       std::to_string(episode) + " episodes, not " + std::to_string(count_) +
                       "; a trained --policy gets there more often");
      }
      RunEpisodeOnce(environment, *agent, static_cast<std::uint64_t>(episode), labels);
    }
    std::cout << written_ << " frames of " << state_ << ": " << out_ << std::endl;
  }

 private:
  void RunEpisodeOnce(TestbedEnv& environment, const Agent& agent, std::uint64_t episode,
                      LineLog& labels) {
    const int wanted = state_[1] - '0';
    const StartKind kind = wanted == 0 ? StartKind::kFolded : StartKind::kUnfolded;
    const std::vector<int> n_actions = environment.ActionCounts();
    Snapshot world = environment.Start(kind, DeriveSeed(seed_, "render start", episode));
    for (int i = 0; i <= kActions && written_ < count_; ++i) {
      if (StopRequested())
        throw RunError("interrupted after " + std::to_string(written_) + " frames");
      const std::uint64_t index = episode * (kActions + 1) + static_cast<std::uint64_t>(i);
      const Percept percept = environment.Begin(world, DeriveSeed(seed_, "render sensor", index));
      // A look at a world that stays as it is: an end has been kept after its action already.
      if (environment.testbed().referee().Judge().state == wanted && wanted < 4) {
        Keep(environment, environment.bagging().frame_before(), environment.bagging().before(),
             labels);
        // One frame per episode where starts alone give the state.
        if (i == 0) return;
      }
      const auto state = static_cast<std::size_t>(percept.state);
      if (state >= n_actions.size()) return;
      Rng rng(DeriveSeed(seed_, "render agent", index));
      const Decision decision =
          agent.Act(percept.state, percept.features, n_actions[state], Mode::kExplore, rng);
      Outcome outcome = environment.Act(decision.action);
      if (outcome.truth.state == wanted && wanted >= 4) {
        Keep(environment, environment.bagging().frame_after(), environment.bagging().after(),
             labels);
      }
      if (outcome.done) return;
      world = std::move(outcome.after);
    }
  }

  void Keep(TestbedEnv& environment, const RgbdFrame& frame, const Observation& seen,
            LineLog& labels) {
    const Truth truth = environment.testbed().referee().Judge();
    char stem[32];
    std::snprintf(stem, sizeof stem, "%s_%05d", state_.c_str(), written_);
    const std::filesystem::path path = std::filesystem::path(out_) / stem;
    WriteImage(path.string() + ".png", frame.color);
    WriteImage(path.string() + "_depth.png", frame.depth_mm);
    WriteImage(path.string() + "_overlay.png", DrawOverlay(frame, seen));
    const nlohmann::ordered_json label = {{"file", std::string(stem) + ".png"},
                                          {"depth", std::string(stem) + "_depth.png"},
                                          {"state", state_},
                                          {"state_seen", StateName(seen.state)},
                                          {"A_bag", truth.bag_area_px2},
                                          {"A_o", truth.opening_area_px2},
                                          {"cube_in_bag", truth.cube_in_bag}};
    labels.Append(label.dump());
    ++written_;
  }

  CommonOptions common_;
  std::string state_;
  int count_ = 10;
  std::uint64_t seed_ = 1;
  std::string out_;
  std::optional<std::string> bag_;
  bool vary_ = false;
  std::string policy_ = "random";
  int written_ = 0;
};

}  // namespace

std::unique_ptr<Command> MakeRenderCommand() { return std::make_unique<RenderCommand>(); }

}  // namespace gusset
