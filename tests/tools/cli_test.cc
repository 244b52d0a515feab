// The program as a user meets it: exit codes, and one line for each mistake.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

namespace gusset {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

struct Result {
  int code = -1;
  std::string out;
  std::string err;
};

class Cli : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "gusset_cli_XXXXXX").string();
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    dir_ = pattern;
  }
  void TearDown() override { fs::remove_all(dir_); }

  Result Gusset(const std::string& arguments) const {
    const std::string command = std::string(GUSSET_BINARY) + " " + arguments + " >" +
                                (dir_ / "out").string() + " 2>" + (dir_ / "err").string();
    const int status = std::system(command.c_str());
    return {WEXITSTATUS(status), Slurp(dir_ / "out"), Slurp(dir_ / "err")};
  }
  static std::string Slurp(const fs::path& file) {
    std::ifstream stream(file);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  fs::path Write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name) << text;
    return dir_ / name;
  }
  // Bad input: exit 2, one line on stderr that holds `text`, nothing on stdout.
  void ExpectRefused(const std::string& arguments, const std::string& text) const {
    const Result result = Gusset(arguments);
    EXPECT_EQ(result.code, 2) << arguments << ": " << result.err;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text)) << arguments;
  }

  fs::path dir_;
};

TEST_F(Cli, HelpEverywhereSucceeds) {
  for (const char* command :
       {"", "train", "evaluate", "play", "render", "classify", "bench", "self-check"}) {
    const Result result = Gusset(std::string(command) + " --help");
    EXPECT_EQ(result.code, 0) << command;
    EXPECT_THAT(result.out, HasSubstr("--help"));
  }
  EXPECT_EQ(Gusset("--version").code, 0);
}

TEST_F(Cli, MistakesInArgumentsEndInOneLine) {
  ExpectRefused("", "subcommand");
  ExpectRefused("bogus", "");
  ExpectRefused("train", "--out");
  ExpectRefused("train --out X --steps", "--steps");
  ExpectRefused("train --agent dqm --out X", "\"double_dqn\"");
  ExpectRefused("render --state s9 --out X", "s9");
  ExpectRefused("evaluate --policy random --episodes 0", "--episodes");
  ExpectRefused("evaluate --policy random --start crumpled", "crumpled");
  ExpectRefused("evaluate --policy random --log-level loud", "loud");
  ExpectRefused("play --out X", "--policy");
  ExpectRefused("bench --only no_such", "no_such");
}

TEST_F(Cli, ValuesOutOfBoundsNameKeyValueBoundAndSource) {
  const std::string out = " --out " + (dir_ / "run").string();
  ExpectRefused("train --steps -1" + out, "--steps: train.steps = -1 is not within [1, ");
  ExpectRefused("train --seed x" + out, "--seed: train.seed = \"x\" must be a whole number");
  ExpectRefused("train --agent dqn" + out, "--agent: train.agent = \"dqn\" is not one of");
  ExpectRefused("train --update sum" + out, "pi.update");
  ExpectRefused("train --set primitives.settle_s=nan" + out, "--set: primitives.settle_s = nan");
  ExpectRefused("train --set nonsense" + out, "--set: nonsense");
  ExpectRefused("train --bag bag9" + out, "bag1, bag2, bag3");
  const fs::path config = Write("c.toml", "\n[primitives]\nsettle_s = -1\n");
  ExpectRefused("train --config " + config.string() + out,
                "c.toml:3: primitives.settle_s = -1 is not within [0, 10]");
  ExpectRefused("train --config /nowhere.toml" + out, "/nowhere.toml");
  EXPECT_FALSE(fs::exists(dir_ / "run")) << "nothing is written before the input is known good";
}

TEST_F(Cli, BagFilesThatDescribeNoBagAreRefused) {
  const auto render = [&](const std::string& bag) {
    return "render --state s0 --bag " + bag + " --out " + (dir_ / "frames").string();
  };
  const auto bag = [&](const std::string& text) { return Write("my.toml", text).string(); };
  ExpectRefused(render("/nowhere.toml"), "/nowhere.toml");
  ExpectRefused(render(dir_.string() + "/none.toml"), "none.toml");
  ExpectRefused(render(bag("[bag]\nthickness_m = -1\n")),
                "my.toml:2: bag.thickness_m = -1 is not within [2e-04, 0.0015]");
  ExpectRefused(render(bag("[bag]\ndepth_m = nan\n")),
                "my.toml:2: bag.depth_m = nan is not within [0.1, 1]");
  ExpectRefused(render(bag("[bag]\nnodes_deep = 9000\n")),
                "my.toml:2: bag.nodes_deep = 9000 is not within [8, 64]");
  ExpectRefused(render(bag("[bag]\nlabels_per_layer = 9\nlabel_width_m = 0.04\n")),
                "my.toml:3: bag.label_width_m = 0.04 is not at most 0.0333333");
  ExpectRefused(render(bag("[bag]\nlabels_per_layer = 8\n[thresholds]\nlabels_per_layer = 5\n")),
                "my.toml:4: thresholds.labels_per_layer = 5 is not bag.labels_per_layer = 8");
  ExpectRefused(render(bag("[thresholds]\nA_th = 40000\n")),
                "my.toml:2: thresholds.A_th = 40000 is not below thresholds.A_flat = 34950");
  ExpectRefused(render(bag("[thresholds]\nA_oth = 5000\n")),
                "my.toml:2: thresholds.A_oth = 5000 is not below thresholds.A_omax = 3900");
  ExpectRefused(render(bag("[bag]\nthicknes_m = 0.001\n")), "did you mean bag.thickness_m?");
  ExpectRefused(render("bag1") + " --set bag.friction_cube=2",
                "--set: bag.friction_cube = 2 is not within [0.2, 0.8]");
  EXPECT_FALSE(fs::exists(dir_ / "frames"));
}

TEST_F(Cli, BrokenImagesAreRefusedByName) {
  ExpectRefused("classify", "images");
  ExpectRefused("classify /nowhere.png", "/nowhere.png");
  ExpectRefused("classify " + Write("a.png", "not a picture").string(), "a.png");
  ExpectRefused("classify " + Write("b.png", "").string(), "b.png");
  ExpectRefused("classify " + dir_.string(), dir_.string());
  ExpectRefused("classify --corpus " + dir_.string(), "labels.jsonl");
}

#ifdef GUSSET_HAS_BENCH
TEST_F(Cli, BenchPrintsOneDocumentWithEveryFigureOfTheContract) {
  const Result result = Gusset("bench --quick --only perception_ms --json");
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json document = nlohmann::json::parse(result.out);
  EXPECT_GT(document.at("perception_ms").get<double>(), 0);
  for (const char* figure : {"rtf_awake", "rtf_action", "vs_bt_deformable", "growth_exponent",
                             "action_ms", "train_s", "two_core_speedup", "world_mb", "frame_ms"}) {
    EXPECT_TRUE(document.at(figure).is_null()) << figure << " was not asked for";
  }
  EXPECT_EQ(document.at("nodes"), 526);
  EXPECT_NE(document.at("machine").at("cpu"), "");
}
#else
TEST_F(Cli, BenchSaysThatThisBuildHasNone) {
  const Result result = Gusset("bench");
  EXPECT_EQ(result.code, 1);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_THAT(result.err, HasSubstr("GUSSET_BUILD_BENCH"));
}
#endif

TEST_F(Cli, ARunFolderThatIsNoneIsRefused) {
  ExpectRefused("train --resume --out " + dir_.string(), "config.toml");
  ExpectRefused("play --run " + dir_.string() + " --step 0 --out " + (dir_ / "x").string(),
                "steps.jsonl");
  ExpectRefused("evaluate --policy " + dir_.string(), "policy.json");
  ExpectRefused("evaluate --policy " + Write("p.json", "{").string(), "p.json");
}

}  // namespace
}  // namespace gusset
