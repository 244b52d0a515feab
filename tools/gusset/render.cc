#include <algorithm>
#include <array>
#include <cstdio>
#include <iostream>
#include <opencv2/imgproc.hpp>

#include "agents/image_file.h"
#include "agents/json_fields.h"
#include "agents/look_files.h"
#include "base/error.h"
#include "base/files.h"
#include "base/stop.h"
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

/// Two worlds are one if no more pixels than this show something else: what rendering the same
/// cloth after a grasp that moved nothing leaves. The smallest label covers as many.
constexpr int kSamePixels = 50;

int DifferentPixels(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat a_shown, b_shown;
  cv::extractChannel(a, a_shown, 0);
  cv::extractChannel(b, b_shown, 0);
  return cv::countNonZero(a_shown != b_shown);
}

bool Same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0; }

// Labelled frames: worlds reached by physics, from the starts and by the actions of a policy, kept
// when ground truth says that the state is one that is asked for.
class RenderCommand final : public Command {
 public:
  const char* name() const override { return "render"; }
  const char* summary() const override { return "Write labelled frames of one state or of all"; }

  void Declare(CLI::App& app) override {
    app.add_option("--state", state_, "s0 to s5, by ground truth, or all")
        ->required()
        ->check(CLI::IsMember({"s0", "s1", "s2", "s3", "s4", "s5", "all"}));
    app.add_option("--count", count_, "How many bags to show in each state")
        ->check(CLI::Range(1, 100000))
        ->capture_default_str();
    app.add_option("--looks", looks_, "Frames of each, with other sensor noise")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    app.add_option("--seed", seed_, "Seed of starts, actions and noise")
        ->check(SeedRange())
        ->capture_default_str();
    app.add_option("--out", out_, "Folder to write")->required()->type_name("DIR");
    app.add_option("--bag", bag_, "Bag: a name in assets/bags or a TOML file [bag1]");
    app.add_option("--policy", policy_, "Who acts on the way to the state")->capture_default_str();
    app.add_flag("--vary", vary_,
                 "Vary light, camera, colours, labels and clutter: variation.amount = 1");
    app.add_flag("--plain", plain_,
                 "Keep frames of the same bags with no labels drawn; who acts still sees them");
    common_.AddTo(app);
  }

  void Run() override {
    common_.StartLog();
    SettingsSource source = SourceOf(policy_, bag_);
    if (vary_) source.assignments.push_back({"--vary", "variation.amount", "1"});
    Settings settings = LoadSettings(common_, source);
    const std::unique_ptr<Agent> agent = LoadAgent(policy_, settings);
    const std::filesystem::path out = out_;
    for (const char* name : {"config.toml", "labels.jsonl"}) {
      if (!Exists(out / name)) continue;
      throw InputError(out_ + ": has a " + name + " already; choose another --out");
    }
    MakeFolder(out);
    perception_ = settings.bagging.perception;
    TestbedEnv environment(MakeTestbed(settings.tree), settings.bagging);
    WriteFileAtomic(out / "camera.json",
                    JsonText(CameraJson(environment.testbed().camera().model())));
    WriteFileAtomic(out / "config.toml", settings.resolved);
    LineLog labels(out / "labels.jsonl");
    for (int s = 0; s < kStates; ++s) {
      if (state_ == "all" || state_[1] - '0' == s) missing_[s] = count_;
    }
    WatchForStop();
    const int most_episodes = kEpisodesPerFrame * count_;
    try {
      for (int episode = 0; !Done(); ++episode) {
        if (episode == most_episodes) {
          throw RunError(std::to_string(frames_) + " frames in " + std::to_string(episode) +
                         " episodes, still missing " + Missing() +
                         "; a trained --policy gets there more often");
        }
        ThrowIfStopped();
        const auto index = static_cast<std::uint64_t>(episode);
        if (!ClearsAlone()) RunEpisodeOnce(environment, *agent, index, labels);
        if (state_ == "all" || ClearsAlone()) KeepCleared(environment, index, labels);
      }
    } catch (const Interrupted&) {
      throw RunError("interrupted after " + std::to_string(frames_) + " frames");
    }
    std::cout << frames_ << " frames of " << state_ << ": " << out_ << std::endl;
  }

 private:
  static constexpr int kStates = 6;

  bool Done() const {
    return std::ranges::all_of(missing_, [](int n) { return n == 0; });
  }

  // Where actions are random, episodes of s4 and s5 are not worth waiting for.
  bool ClearsAlone() const { return policy_ == "random" && (state_ == "s4" || state_ == "s5"); }

  std::string Missing() const {
    std::string text;
    for (int s = 0; s < kStates; ++s) {
      if (missing_[s] == 0) continue;
      text +=
          (text.empty() ? "" : ", ") + std::to_string(missing_[s]) + " of s" + std::to_string(s);
    }
    return text;
  }

  // Bags folded and laid flat, near the middle or anywhere. A folded start takes as long to make as
  // ten actions, and drags fold bags up, too: every fourth episode has one, while they are wanted.
  StartKind KindOf(std::uint64_t episode) const {
    if (state_ != "all") return state_ == "s0" ? StartKind::kFolded : StartKind::kUnfolded;
    const bool folded = missing_[0] > 0 && episode % 4 == 1;
    const bool any_pose = episode / 4 % 2 == 1 || episode % 2 == 0;
    if (folded) return any_pose ? StartKind::kFoldedAnyPose : StartKind::kFolded;
    return any_pose ? StartKind::kUnfoldedAnyPose : StartKind::kUnfolded;
  }

  void RunEpisodeOnce(TestbedEnv& environment, const Agent& agent, std::uint64_t episode,
                      LineLog& labels) {
    const std::vector<int> n_actions = environment.ActionCounts();
    Snapshot world = environment.Start(KindOf(episode), DeriveSeed(seed_, "render start", episode));
    cv::Mat shown_before;
    for (int i = 0; i <= kActions && !Done(); ++i) {
      ThrowIfStopped();
      const std::uint64_t index = episode * (kActions + 1) + static_cast<std::uint64_t>(i);
      const Percept percept = environment.Begin(world, DeriveSeed(seed_, "render sensor", index));
      const FrameTruth truth = environment.testbed().Describe();
      const bool other =
          shown_before.empty() || DifferentPixels(truth.surface, shown_before) > kSamePixels;
      shown_before = truth.surface;
      if (other && missing_[truth.truth.state] > 0) {
        --missing_[truth.truth.state];
        KeepLooks(environment, world, truth, index, labels);
        // One bag per episode where starts alone give the state.
        if (i == 0 && state_ != "all") return;
      }
      const auto state = static_cast<std::size_t>(percept.state);
      if (state >= n_actions.size()) return;
      Rng rng(DeriveSeed(seed_, "render agent", index));
      const Decision decision =
          agent.Act(percept.state, percept.features, n_actions[state], Mode::kExplore, rng);
      Outcome outcome = environment.Act(decision.action);
      world = std::move(outcome.after);
    }
  }

  // Success and failure are rare where actions are random, so a person clears the table, too.
  void KeepCleared(TestbedEnv& environment, std::uint64_t episode, LineLog& labels) {
    for (const int state : {4, 5}) {
      if (missing_[state] == 0) continue;
      const auto seed = DeriveSeed(DeriveSeed(seed_, "render cleared", episode), "state",
                                   static_cast<std::uint64_t>(state));
      environment.Start(StartKind::kUnfolded, DeriveSeed(seed_, "render cleared start"));
      environment.testbed().ClearTable(/*in_middle=*/state == 5, seed);
      const Snapshot world = environment.testbed().scene().Save();
      const std::uint64_t index = ClearedIndex(episode, state);
      environment.Begin(world, DeriveSeed(seed_, "render sensor", index));
      const FrameTruth truth = environment.testbed().Describe();
      if (truth.truth.state != state) continue;
      --missing_[state];
      KeepLooks(environment, world, truth, index, labels);
    }
  }

  // The seeds' index of worlds that are no step of an episode; steps count from 0 up.
  static std::uint64_t ClearedIndex(std::uint64_t episode, int state) {
    return ~(episode * 2 + static_cast<std::uint64_t>(state - 4));
  }

  // The look that was just had, and further ones at the same world; the world is then as it was.
  void KeepLooks(TestbedEnv& environment, const Snapshot& world, const FrameTruth& truth,
                 std::uint64_t index, LineLog& labels) {
    const std::uint64_t first = DeriveSeed(seed_, "render sensor", index);
    if (plain_) {
      environment.testbed().DrawLabels(false);
      environment.Begin(world, first);
    }
    Keep(environment, truth, 0, labels);
    for (int look = 1; look < looks_; ++look) {
      ThrowIfStopped();
      const auto k = static_cast<std::uint64_t>(look);
      environment.Begin(world, DeriveSeed(DeriveSeed(seed_, "render look", k), "world", index));
      // What varies may take labels away, and with them A_o and the state.
      Keep(environment, environment.testbed().Describe(), look, labels);
    }
    if (plain_) environment.testbed().DrawLabels(true);
    if (plain_ || looks_ > 1) environment.Begin(world, first);
    ++worlds_;
  }

  void Keep(TestbedEnv& environment, const FrameTruth& truth, int look, LineLog& labels) {
    const RgbdFrame& frame = environment.bagging().frame_before();
    const Observation& seen = environment.bagging().before();
    const std::string state = "s" + std::to_string(truth.truth.state);
    char stem[48];
    std::snprintf(stem, sizeof stem, "%s_%05d", state.c_str(), written_[truth.truth.state]++);
    const std::string path = (std::filesystem::path(out_) / stem).string();
    if (look == 0) {
      (void)WriteLook(path, {frame, seen, truth.truth}, environment.testbed().camera().model(),
                      perception_);
    } else {
      WriteImage(path + ".png", frame.color);
      WriteImage(path + "_depth.png", frame.depth_mm);
    }
    if (look == 0 || !Same(truth.surface, surface_)) {
      surface_ = truth.surface;
      std::snprintf(surface_name_.data(), surface_name_.size(), "surface_%05d.png", surfaces_++);
      WriteImage(std::filesystem::path(out_) / surface_name_.data(), surface_);
    }
    nlohmann::ordered_json centres = nlohmann::ordered_json::array();
    for (const cv::Point2d& px : truth.label_centre_px) centres.push_back({px.x, px.y});
    const nlohmann::ordered_json label = {
        {"file", std::string(stem) + ".png"},
        {"depth", std::string(stem) + "_depth.png"},
        {"surface", surface_name_.data()},
        {"world", worlds_},
        {"state", state},
        {"state_seen", StateName(seen.state)},
        {"A_bag", truth.truth.bag_area_px2},
        {"A_o", truth.truth.opening_area_px2},
        {"labels", truth.labels_seen},
        {"label_px2", truth.label_px2},
        {"label_centre_px", centres},
        {"cube_px", truth.cube_px},
        {"cube_m", {truth.cube_m.x(), truth.cube_m.y(), truth.cube_m.z()}},
        {"cube_hidden", truth.cube_hidden},
        {"cube_in_bag", truth.truth.cube_in_bag},
        {"plain", plain_}};
    labels.Append(label.dump());
    ++frames_;
  }

  CommonOptions common_;
  std::string state_;
  int count_ = 10;
  int looks_ = 1;
  std::uint64_t seed_ = 1;
  std::string out_;
  std::optional<std::string> bag_;
  bool vary_ = false;
  bool plain_ = false;
  std::string policy_ = "random";
  PerceptionConfig perception_;
  std::array<int, kStates> missing_{};  ///< Bags still to be shown, per state.
  std::array<int, kStates> written_{};  ///< Frames, per state.
  int frames_ = 0;
  int worlds_ = 0;
  cv::Mat surface_;                      ///< The last one that was written,
  std::array<char, 48> surface_name_{};  ///< its file,
  int surfaces_ = 0;                     ///< and how many were.
};

}  // namespace

std::unique_ptr<Command> MakeRenderCommand() { return std::make_unique<RenderCommand>(); }

}  // namespace gusset
