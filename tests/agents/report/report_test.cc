#include "agents/report/report.h"

#include <gmock/gmock.h>

#include "agents/image_file.h"
#include "agents/pi_learning.h"
#include "agents/report/contact_sheet.h"
#include "agents/report/dumped_action.h"
#include "agents/report/footage.h"
#include "agents/report/run_data.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;
using testing::ElementsAre;
using testing::HasSubstr;

const Published kNothing;

class Report : public FolderTest {
 protected:
  fs::path Trained(const std::string& name, TrainConfig config) {
    std::string toml;
    AppendToml("train", config, toml);
    Workers workers(1, [] { return std::make_unique<TableWorld>(); });
    PiLearning agent({.steps_per_state = config.steps}, TableWorld().ActionCounts());
    const RunFolder folder = RunFolder::Create(dir_ / name, toml, ordered_json::object());
    Train(workers, agent, config, folder, {}, [] { return false; });
    return folder.root();
  }
  // The frames of one action.
  void Dump(const fs::path& prefix, ordered_json about) {
    ordered_json document = {{"step", 0},         {"state", 3},       {"action", 7},
                             {"reward", -0.1},    {"next_state", 5},  {"next_state_true", 5},
                             {"done", true},      {"success", false}, {"success_true", false},
                             {"before", nullptr}, {"after", nullptr}};
    document.update(about);
    fs::create_directories(prefix.parent_path());
    for (const char* when : {"_before", "_after"}) {
      WriteImage(prefix.string() + when + "_overlay.png", cv::Mat::zeros(34, 34, CV_8UC3));
    }
    WriteFileAtomic(prefix.string() + ".json", document.dump());
  }
  template <class Function>
  static std::string Refusal(Function function) {
    try {
      function();
    } catch (const InputError& e) {
      return e.what();
    }
    return "accepted";
  }
};

TEST(OutcomeName, NamesEveryEnd) {
  EXPECT_EQ(OutcomeName(3, 4, true, true, true), "success");
  EXPECT_EQ(OutcomeName(3, 5, true, false, true), "success") << "truth counts";
  EXPECT_EQ(OutcomeName(3, 4, true, true, false), "false success");
  EXPECT_EQ(OutcomeName(3, 2, false, false, false), "not carried");
  EXPECT_EQ(OutcomeName(1, 4, true, false, false), "lost");
  EXPECT_EQ(OutcomeName(0, 2, false, false, false), "advanced");
  EXPECT_EQ(OutcomeName(2, 2, false, false, false), "no progress");
  EXPECT_EQ(OutcomeName(2, 0, false, false, false), "no progress");
}

TEST_F(Report, CountsWhatTheLogHolds) {
  const fs::path run = Trained("run", {.steps = 6, .dump = "all"});
  const RunData data = ReadRun(run);
  // The dumped frames know of the same actions, by another way.
  std::vector<double> rewards;
  int advanced = 0;
  for (const DumpedAction& action : ReadDumpedActions(run / "frames")) {
    const bool learnt = ReadJson(action.prefix.string() + ".json")["kind"] == "train";
    if (action.state != 2 || !learnt) continue;
    rewards.push_back(action.reward);
    advanced += action.outcome == "advanced";
  }
  ASSERT_EQ(rewards.size(), 6u);
  EXPECT_EQ(data.rewards[2], rewards);
  EXPECT_EQ(data.training[2].attempts, 6);
  EXPECT_EQ(data.training[2].successes, advanced);
  EXPECT_EQ(data.sim_s, 10.0 * data.actions) << "TableWorld's actions take 10 s";
  EXPECT_GT(data.actions, 24);
  EXPECT_FALSE(data.config.contains("train.seed"));
  EXPECT_EQ(data.config.at("train.steps"), "6");
}

TEST_F(Report, SeedsOfAnExperimentBecomeOneGroupBesideItsTables) {
  const fs::path a = Trained("exp/runs/pi-seed1", {.steps = 5, .seed = 1});
  Trained("exp/runs/pi-seed2", {.steps = 5, .seed = 2});
  WriteFileAtomic(dir_ / "exp" / "results.csv",
                  "table,row,column,seed,n,successes,value,low,high,published,published_low,"
                  "published_high,unit,seconds_wall,seconds_sim,command,versions\n"
                  "5.6,pi,step1,pooled,4,3,0.75,0.3,0.95,0.7,0.4,0.9,rate,1,2,c,v\n");
  const ordered_json report = CollectReport({dir_ / "exp"}, kNothing);
  ASSERT_EQ(report["groups"].size(), 1u);
  EXPECT_THAT(report["groups"][0]["seeds"], ElementsAre(1, 2));
  EXPECT_EQ(report["groups"][0]["curves"][3]["mean"].size(), 5u);
  EXPECT_EQ(report["groups"][0]["training"][0]["n"], 10);
  EXPECT_EQ(report["tables"][0]["cells"][0]["ours"]["value"], 0.75);
  EXPECT_EQ(report["tables"][0]["cells"][0]["published"]["low"], 0.4);
  EXPECT_EQ(CollectReport({a}, kNothing)["tables"].size(), 0u);
}

TEST_F(Report, TheThesissFiguresStandBesideItsLearners) {
  const Published thesis =
      Published::Load(fs::path(GUSSET_SOURCE_DIR) / "assets" / "published" / "thesis.toml");
  const fs::path run = Trained("pi10", {.steps = 10});
  const ordered_json tally = {{"attempts", 4}, {"successes", 3}};
  ordered_json evaluation = {{"policy", "out/pi10"},
                             {"repeats", 5},
                             {"bag", "bag1"},
                             {"start", "folded"},
                             {"pose", "near"},
                             {"episodes", 4},
                             {"true_successes", 2},
                             {"perceived_successes", 2},
                             {"per_step", {tally, tally, tally, tally}}};
  WriteFileAtomic(run / "evaluation_folded.json", evaluation.dump());
  evaluation["pose"] = "any";
  WriteFileAtomic(run / "evaluation_pose.json", evaluation.dump());
  evaluation["pose"] = "near";
  evaluation["repeats"] = 1;
  WriteFileAtomic(run / "evaluation_once.json", evaluation.dump());
  evaluation["repeats"] = 5;
  evaluation["policy"] = "random";
  WriteFileAtomic(run / "evaluation_random.json", evaluation.dump());
  evaluation["policy"] = "out/pi10";
  evaluation["overrides"] = {"sensor.preset = \"clean\""};
  WriteFileAtomic(run / "evaluation_clean.json", evaluation.dump());
  evaluation.erase("overrides");
  const ordered_json group = CollectReport({run}, thesis)["groups"][0];
  EXPECT_EQ(group["published_rewards"][1]["value"], 0.014) << "Table 5.5, Ours(10)";
  ASSERT_EQ(group["evaluations"].size(), 5u);
  for (const ordered_json& one : group["evaluations"]) {
    const bool known = one["pose"] == "near" && one["repeats"] == 5 && one["random"] == false &&
                       one["overrides"] == "";
    EXPECT_EQ(one["published_success"].is_null(), !known) << "the thesis has none like this";
    if (!known) continue;
    EXPECT_EQ(one["published_success"]["value"], 0.0) << "Table 5.6, Ours(10)";
  }
  const fs::path whole = Trained("pi100", {.steps = 100});
  evaluation["pose"] = "near";
  evaluation["bag"] = "bag2";
  WriteFileAtomic(whole / "evaluation_folded.json", evaluation.dump());
  const ordered_json moved = CollectReport({whole}, thesis)["groups"][0]["evaluations"][0];
  EXPECT_EQ(moved["published_success"]["value"], 0.2) << "Table 5.7, Bag 2";
  const auto rewards_of = [&](const fs::path& of) {
    return CollectReport({of}, thesis)["groups"][0]["published_rewards"][1];
  };
  EXPECT_TRUE(rewards_of(Trained("pi6", {.steps = 6})).is_null());
  EXPECT_TRUE(rewards_of(Trained("chain", {.protocol = "chain", .steps = 10})).is_null());
}

TEST_F(Report, OneFilmOfEachKindAndSuccessesFirst) {
  const fs::path frames = dir_ / "evaluation_frames";
  const ordered_json failed = {{"episode_success_true", false}};
  for (const int episode : {0, 1}) {
    ordered_json about = failed;
    about["episode"] = episode;
    Dump(frames / ("e" + std::to_string(episode)), about);
  }
  Dump(frames / "e2", {{"episode", 2}, {"episode_success_true", true}, {"success_true", true}});
  Dump(frames / "e3", {{"episode", 3},
                       {"episode_success_true", false},
                       {"state", 1},
                       {"next_state", 1},
                       {"next_state_true", 1},
                       {"done", false}});
  Dump(dir_ / "frames" / "step4",
       {{"state", 0}, {"next_state", 0}, {"next_state_true", 0}, {"done", false}});
  Dump(dir_ / "frames" / "step5",
       {{"state", 0}, {"next_state", 1}, {"next_state_true", 1}, {"done", false}});
  std::vector<std::string> kinds;
  for (const Film& film : FindFilms(dir_)) {
    kinds.push_back(film.kind);
    EXPECT_EQ(film.frames.size(), 2u);
  }
  EXPECT_THAT(kinds, ElementsAre("success", "not carried", "given up in s1 unfolded",
                                 "in training: s0 folded, no progress"));
}

TEST_F(Report, BrokenFilesAreNamed) {
  const fs::path run = Trained("run", {.steps = 2});
  const auto refusal = [&] { return Refusal([&] { (void)CollectReport({run}, kNothing); }); };
  EXPECT_EQ(refusal(), "accepted");
  EXPECT_THAT(Refusal([&] { (void)CollectReport({dir_ / "none"}, kNothing); }),
              HasSubstr("is not a folder"));
  EXPECT_THAT(Refusal([&] { (void)CollectReport({dir_}, kNothing); }),
              HasSubstr("holds neither a run"));

  const std::string steps = ReadFile(run / "steps.jsonl");
  const auto lines = std::count(steps.begin(), steps.end(), '\n');
  WriteFileAtomic(run / "steps.jsonl",
                  steps + "{\"step\": " + std::to_string(lines) + ", \"state\": 4}\n");
  EXPECT_THAT(refusal(), HasSubstr("steps.jsonl:" + std::to_string(lines + 1) +
                                   ": state = 4 is not within [0, 3]"));
  WriteFileAtomic(run / "steps.jsonl", steps + steps);
  EXPECT_THAT(refusal(), HasSubstr(": step = 0 is not within ["));
  WriteFileAtomic(run / "steps.jsonl", steps);
  EXPECT_THAT(Refusal([&] {
                (void)CollectReport({run, run / "."}, kNothing);
              }),
              HasSubstr("is given twice"));

  WriteFileAtomic(run / "evaluation_x.json", "{\"bag\": \"b\", \"start\": 1}");
  EXPECT_THAT(refusal(), HasSubstr("evaluation_x.json: start = 1 has the wrong type"));
  WriteFileAtomic(run / "evaluation_x.json", "{\"bag\": \"b\", \"start\": \"sideways\"}");
  EXPECT_THAT(refusal(), HasSubstr("start = \"sideways\" is not one of folded, unfolded"));
  WriteFileAtomic(
      run / "evaluation_x.json",
      R"({"bag": "b", "start": "folded", "pose": "near", "policy": "p", "repeats": 5, "episodes": 3, "true_successes": 2,
                      "perceived_successes": 1, "per_step": [{"attempts": 3, "successes": 4}, 1, 1,
                      1]})");
  EXPECT_THAT(refusal(), HasSubstr("per_step[0].successes = 4 is not within [0, 3]"));
  fs::remove(run / "evaluation_x.json");

  WriteFileAtomic(run / "reward_map_s1.png", "no picture");
  EXPECT_THAT(refusal(), HasSubstr("reward_map_s1.png: is not an image"));
  fs::remove(run / "reward_map_s1.png");

  Dump(run / "frames" / "step0", {{"reward", "much"}});
  EXPECT_THAT(refusal(), HasSubstr("step0.json: reward = \"much\" has the wrong type"));
  EXPECT_THAT(Refusal([&] { WriteContactSheet(run / "frames"); }), HasSubstr("step0.json: reward"));
  fs::remove(run / "frames" / "step0.json");

  WriteFileAtomic(run / "config.toml", "\n[train]\nsteps = -3\n");
  EXPECT_THAT(refusal(), HasSubstr("config.toml:3: train.steps = -3 is not within"));
}

}  // namespace
}  // namespace gusset
