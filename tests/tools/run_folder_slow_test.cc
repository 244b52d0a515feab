// What a run folder promises, kept by the real program on the real physics: however training ends
// (killed, stopped, no room on the disk) it goes on to the same bits, and nothing that was written
// is damaged.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "agents/replay.h"
#include "agents/run_folder.h"
#include "base/files.h"
#include "tests/temporary_folder.h"
#include "tools/gusset/settings.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

// A coarse bag, any heap of it as a start, and thresholds that little suffices for: some ten
// actions of a second or less go through all four states. How often they succeed is not asked here.
constexpr const char* kConfig = R"(
[train]
steps = 2
pool_min = 2
max_extra_actions = 8
[bag]
nodes_across = 10
nodes_deep = 12
[starts]
folded_area_max_px = 18000
mouth_labels = 11
[thresholds]
A_th = 18000
A_oth = 200
A_flat = 25000
[primitives.pick_place]
room_m = 0
[primitives]
settle_s = 0.5
)";
constexpr int kMostSeeds = 8;
constexpr auto kPatience = std::chrono::minutes(5);

struct Exit {
  int code = -1;   // of a process that ended by itself
  int signal = 0;  // that ended it
  std::string err;
};

// A started `gusset`; it does not outlive this object.
class Program {
 public:
  // No file may grow beyond `most_bytes`: as a full disk, but for errno.
  Program(const std::vector<std::string>& arguments, const fs::path& err,
          rlim_t most_bytes = RLIM_INFINITY)
      : err_(err) {
    std::vector<char*> argv = {const_cast<char*>(GUSSET_BINARY)};
    for (const std::string& argument : arguments) {
      argv.push_back(const_cast<char*>(argument.c_str()));
    }
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    const rlimit limit = {most_bytes, most_bytes};
    ::signal(SIGXFSZ, SIG_IGN);
    const bool ready = ::setrlimit(RLIMIT_FSIZE, &limit) == 0 &&
                       ::freopen("/dev/null", "w", stdout) != nullptr &&
                       ::freopen(err.c_str(), "w", stderr) != nullptr;
    if (ready) ::execv(GUSSET_BINARY, argv.data());
    ::_exit(127);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program() {
    if (Ended()) return;
    Send(SIGKILL);
    ::waitpid(pid_, &status_, 0);
  }

  void Send(int signal) const { ::kill(pid_, signal); }
  bool Ended() {
    if (!ended_) ended_ = ::waitpid(pid_, &status_, WNOHANG) == pid_;
    return ended_;
  }
  Exit Wait() {
    if (!ended_) ended_ = ::waitpid(pid_, &status_, 0) == pid_;
    return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -1,
            WIFSIGNALED(status_) ? WTERMSIG(status_) : 0, ReadFile(err_)};
  }
  // Waits until `holds`. @returns false if the program ends before.
  template <class Condition>
  bool WaitUntil(Condition holds) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (!holds()) {
      if (Ended() || std::chrono::steady_clock::now() > deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return true;
  }

 private:
  fs::path err_;
  pid_t pid_ = -1;
  bool ended_ = false;
  int status_ = 0;
};

// Whole lines of the log.
long Lines(const fs::path& run) {
  if (!fs::exists(run / "steps.jsonl")) return 0;
  return std::ranges::count(ReadFile(run / "steps.jsonl"), '\n');
}

// Actions that --resume would not do again.
long ActionsKept(const fs::path& run) {
  const fs::path file = run / "checkpoint" / "state.json";
  return fs::exists(file) ? ReadJson(file).at("progress").at("actions").get<long>() : 0;
}

// All that a finished run must have in common with another one of the same seed, by file.
std::map<std::string, std::string> Results(const fs::path& run) {
  std::map<std::string, std::string> results;
  for (const auto& entry : fs::recursive_directory_iterator(run)) {
    const fs::path& file = entry.path();
    if (file.extension() == ".png" || file.extension() == ".snapshot" ||
        file.extension() == ".toml" || file.filename() == "policy.json") {
      results[file.lexically_relative(run)] = ReadFile(file);
    }
  }
  for (json step : ReadRunSteps(run)) {
    step.erase("wall_s");
    results["steps.jsonl"] += step.dump() + "\n";
  }
  std::istringstream progress(ReadFile(run / "progress.csv"));
  for (std::string line; std::getline(progress, line);) {
    results["progress.csv"] += line.substr(0, line.rfind(',')) + "\n";  // less actions_per_second
  }
  return results;
}

// The tests share one run that nothing interrupted.
class TrainingRun : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    dir_ = folder_->path();
    WriteFileAtomic(dir_ / "coarse.toml", kConfig);
    ::setenv("GUSSET_CACHE", (dir_ / "cache").c_str(), 1);
    // Not every seed's bags come through all states within so few actions, nor need extra ones.
    for (seed_ = 1; seed_ <= kMostSeeds; ++seed_) {
      const fs::path run = dir_ / ("unbroken" + std::to_string(seed_));
      if (Program(New(run), dir_ / "err").Wait().code != 0) continue;
      const std::vector<json> steps = ReadRunSteps(run);
      if (std::ranges::count(steps, "extra", [](const json& s) { return s["kind"]; }) == 0)
        continue;
      unbroken_ = Results(run);
      unbroken_run_ = run;
      return;
    }
  }
  static void TearDownTestSuite() { folder_.reset(); }
  void SetUp() override {
    ASSERT_FALSE(unbroken_.empty())
        << "no seed up to " << kMostSeeds << " came through all states with extra actions";
  }

  static std::vector<std::string> New(const fs::path& run, int jobs = 1) {
    return {"train",
            "--config",
            (dir_ / "coarse.toml").string(),
            "--seed",
            std::to_string(seed_),
            "--out",
            run,
            "--jobs",
            std::to_string(jobs),
            "--log-level",
            "off"};
  }
  static std::vector<std::string> Resume(const fs::path& run, int jobs = 1) {
    return {"train",  "--resume",           "--out",       run,
            "--jobs", std::to_string(jobs), "--log-level", "off"};
  }
  static void ExpectToEndLikeTheUnbrokenRun(const std::vector<std::string>& arguments,
                                            const fs::path& run) {
    const Exit exit = Program(arguments, dir_ / "err").Wait();
    ASSERT_EQ(exit.code, 0) << exit.err;
    const std::map<std::string, std::string> results = Results(run);
    for (const auto& [file, contents] : unbroken_) {
      ASSERT_TRUE(results.contains(file)) << file;
      EXPECT_TRUE(results.at(file) == contents) << file;
    }
    EXPECT_EQ(results.size(), unbroken_.size());
  }
  static void ExpectOneLine(const Exit& exit, int code, const std::string& text) {
    EXPECT_EQ(exit.code, code) << exit.err;
    EXPECT_EQ(std::ranges::count(exit.err, '\n'), 1) << exit.err;
    EXPECT_THAT(exit.err, HasSubstr(text));
  }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static fs::path dir_;
  inline static int seed_ = 0;
  inline static fs::path unbroken_run_;
  inline static std::map<std::string, std::string> unbroken_;
};

TEST_F(TrainingRun, LearnsInAllFourStatesAndFillsAPool) {
  std::map<int, int> learnt;
  int extra = 0;
  for (const json& step : ReadRunSteps(unbroken_run_)) {
    if (step["kind"] == "train") ++learnt[step["state"]];
    extra += step["kind"] == "extra";
  }
  EXPECT_THAT(learnt, testing::ElementsAre(testing::Pair(0, 2), testing::Pair(1, 2),
                                           testing::Pair(2, 2), testing::Pair(3, 2)));
  EXPECT_GT(extra, 0);
}

TEST_F(TrainingRun, TheSameSeedGivesTheSameBitsForAnyNumberOfWorkers) {
  for (const int jobs : {1, 2}) {
    const fs::path run = dir_ / ("jobs" + std::to_string(jobs));
    ExpectToEndLikeTheUnbrokenRun(New(run, jobs), run);
  }
}

// Each life is killed as soon as it has added a line, mostly before the checkpoint that counts it.
TEST_F(TrainingRun, KilledAgainAndAgainItEndsLikeTheUnbrokenRun) {
  const fs::path run = dir_ / "killed";
  for (int life = 0; life < 3; ++life) {
    const int jobs = 1 + life % 2;
    const long before = Lines(run);
    Program gusset(life == 0 ? New(run, jobs) : Resume(run, jobs), dir_ / "err");
    ASSERT_TRUE(gusset.WaitUntil([&] { return Lines(run) > before; })) << gusset.Wait().err;
    gusset.Send(SIGKILL);
    ASSERT_EQ(gusset.Wait().signal, SIGKILL);
    ASSERT_FALSE(fs::exists(run / "policy.json"));
  }
  ExpectToEndLikeTheUnbrokenRun(Resume(run), run);
}

TEST_F(TrainingRun, StoppedItSaysHowToGoOnAndEndsLikeTheUnbrokenRun) {
  const fs::path run = dir_ / "stopped";
  for (const int signal : {SIGINT, SIGTERM}) {
    const long before = ActionsKept(run);
    Program gusset(before == 0 ? New(run) : Resume(run), dir_ / "err");
    ASSERT_TRUE(gusset.WaitUntil([&] { return ActionsKept(run) > before; })) << gusset.Wait().err;
    gusset.Send(signal);
    const Exit exit = gusset.Wait();
    ExpectOneLine(exit, 1, run.string() + " can be continued with --resume");
    EXPECT_THAT(exit.err, HasSubstr("after " + std::to_string(Lines(run)) + " actions"));
    EXPECT_EQ(ActionsKept(run), Lines(run));
    ASSERT_FALSE(fs::exists(run / "policy.json"));
  }
  ExpectToEndLikeTheUnbrokenRun(Resume(run), run);
}

// The room runs out for one kind of file after the other, each larger than those before. Starts are
// made again meanwhile, as the cache that they are kept in is full as well.
TEST_F(TrainingRun, WithoutRoomOnTheDiskItNamesTheFileAndDamagesNothing) {
  ::setenv("GUSSET_CACHE", (dir_ / "full_cache").c_str(), 1);
  const fs::path run = dir_ / "full";
  const auto expect_to_fail = [&](const std::vector<std::string>& arguments, std::uintmax_t most,
                                  const std::string& file) {
    SCOPED_TRACE(file);
    ExpectOneLine(Program(arguments, dir_ / "err", most).Wait(), 1, file + ": cannot write: ");
    for (const char* folder : {"full", "full_cache"}) {
      if (!fs::exists(dir_ / folder)) continue;
      for (const auto& entry : fs::recursive_directory_iterator(dir_ / folder)) {
        EXPECT_THAT(entry.path().extension(), AllOf(testing::Ne(".tmp"), testing::Ne(".part")));
      }
    }
    if (!fs::exists(run / "steps.jsonl")) return;
    EXPECT_GE(static_cast<long>(ReadRunSteps(run).size()), ActionsKept(run)) << "every line parses";
    const std::string log = ReadFile(run / "steps.jsonl");
    EXPECT_TRUE(log.empty() || log.ends_with('\n'));
  };
  expect_to_fail(New(run), fs::file_size(unbroken_run_ / "config.toml") - 1, "config.toml");
  EXPECT_FALSE(fs::exists(run / "config.toml")) << "the folder counts as a run already";

  std::uintmax_t snapshot_bytes = 0;
  for (const auto& [file, contents] : unbroken_) {
    if (file.ends_with(".snapshot")) snapshot_bytes = contents.size();
  }
  expect_to_fail(New(run), snapshot_bytes - 1, ".snapshot");
  EXPECT_GT(Lines(run), ActionsKept(run)) << "the line of the world that found no room";

  // That line again, which may be some bytes shorter now, as its wall time differs.
  expect_to_fail(Resume(run), fs::file_size(run / "steps.jsonl") - 50, "steps.jsonl");
  EXPECT_EQ(Lines(run), ActionsKept(run)) << "half a line was cut off";
  EXPECT_FALSE(fs::exists(run / "policy.json"));

  const char* picture = "reward_map_s0.png";
  expect_to_fail(Resume(run), fs::file_size(unbroken_run_ / picture) - 1, picture);
  EXPECT_TRUE(ReadFile(run / "policy.json") == unbroken_.at("policy.json"));
  ExpectToEndLikeTheUnbrokenRun(Resume(run), run);
  ::setenv("GUSSET_CACHE", (dir_ / "cache").c_str(), 1);
}

TEST_F(TrainingRun, AFolderThatCannotBeMadeIsRefusedByName) {
  WriteFileAtomic(dir_ / "file", "");
  for (const fs::path& run : {fs::path("/proc/nope"), dir_ / "file", dir_ / "file" / "run"}) {
    ExpectOneLine(Program(New(run), dir_ / "err").Wait(), 2, run.string());
  }
}

// Every logged action once more, from last to first: each in a process and after a world in which
// it was not run then.
TEST_F(TrainingRun, ItsActionsGiveTheSameBitsInAnotherProcessAndOrder) {
  const Settings settings = LoadSettings({}, {.base = unbroken_run_ / "config.toml"});
  const std::unique_ptr<Environment> environment = settings.EnvironmentFactory()();
  const RunFolder folder = RunFolder::Open(unbroken_run_);
  const auto again = [&](const json& step) {
    const json& from = step["from"];
    const Snapshot world = from.contains("seed")
                               ? environment->Start(StartKind::kFolded, from["seed"])
                               : folder.ReadSnapshot(from["step"]);
    EXPECT_EQ(environment->Begin(world, step["sensor_seed"]).state, step["state"]);
    return environment->Act(step["action"]);
  };
  const std::vector<json> steps = ReadRunSteps(unbroken_run_);
  const Outcome first = again(steps.back());
  int compared = 0;
  for (auto step = steps.rbegin(); step != steps.rend(); ++step) {
    SCOPED_TRACE(step->dump());
    const Outcome outcome = again(*step);
    EXPECT_EQ(json(outcome.reward), step->at("reward"));
    EXPECT_EQ(json(outcome.sim_s), step->at("sim_s"));
    for (const auto& [key, value] : outcome.log.items()) EXPECT_EQ(json(value), step->at(key));
    const std::string kept =
        "checkpoint/step" + std::to_string(steps.rend() - step - 1) + ".snapshot";
    if (!unbroken_.contains(kept)) continue;
    EXPECT_TRUE(outcome.after == unbroken_.at(kept)) << kept;
    ++compared;
  }
  EXPECT_GT(compared, 3);
  EXPECT_TRUE(again(steps.back()).after == first.after);
}

}  // namespace
}  // namespace gusset
