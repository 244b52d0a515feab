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
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <set>
#include <sstream>
#include <string>

#include "base/files.h"
#include "tests/temporary_folder.h"

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

  TemporaryFolder folder_;
  fs::path dir_ = folder_.path();
};

TEST_F(Cli, HelpEverywhereSucceeds) {
  for (const char* command : {"", "train", "evaluate", "play", "experiment", "experiment thesis",
                              "render", "classify", "bench", "report", "self-check"}) {
    const Result result = Gusset(std::string(command) + " --help");
    EXPECT_EQ(result.code, 0) << command;
    EXPECT_THAT(result.out, HasSubstr("--help"));
  }
  EXPECT_EQ(Gusset("--version").code, 0);
}

// A file that takes a closed stream's number would get the log between its lines.
TEST_F(Cli, StreamsThatAreClosedAreOpenedOntoNothing) {
  const std::string command =
      std::string(GUSSET_BINARY) + " self-check --config /proc/self/fd/2 >/dev/null 2>&-";
  EXPECT_EQ(std::system(command.c_str()), 0) << "/proc/self/fd/2 is not there to be read";
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
  ExpectRefused("evaluate --policy random --dump all", "--dump all needs --out");
  ExpectRefused("evaluate --policy random --out /", "/: cannot write");
  ExpectRefused("report /nowhere --out /no/such/page.html", "/no/such/page.html: cannot write");
  ExpectRefused("evaluate --policy random --dump some --out X", "some");
  ExpectRefused("report --out X", "folders");
  ExpectRefused("bench --only no_such", "no_such");
}

TEST_F(Cli, ValuesOutOfBoundsNameKeyValueBoundAndSource) {
  const std::string out = " --out " + (dir_ / "run").string();
  ExpectRefused("train --steps -1" + out, "--steps: train.steps = -1 is not within [1, ");
  ExpectRefused("train --seed x" + out, "--seed: train.seed = \"x\" must be a whole number");
  ExpectRefused("train --agent sarsa" + out, "--agent: train.agent = \"sarsa\" is not one of");
  ExpectRefused("train --update sum" + out, "pi.update");
  ExpectRefused("train --set primitives.settle_s=nan" + out, "--set: primitives.settle_s = nan");
  ExpectRefused("train --set nonsense" + out, "--set: nonsense");
  ExpectRefused("train --bag bag9" + out, "bag1, bag2, bag3");
  const fs::path config = Write("c.toml", "\n[primitives]\nsettle_s = -1\n");
  ExpectRefused("train --config " + config.string() + out,
                "c.toml:3: primitives.settle_s = -1 is not within [0, 10]");
  ExpectRefused("train --set perception.hem_min_px=9.5" + out,
                "perception.hem_min_px = 9.5 is above hem_max_px = 9");
  ExpectRefused("train --set perception.depth_max_m=0.2" + out,
                "perception.depth_max_m = 0.2 is below depth_min_m = 0.3");
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
  // Bag 1's limit would have every lighter bag laid down again as empty.
  ExpectRefused(render(bag("[bag]\narea_density_kg_m2 = 0.1\nflexural_rigidity_Nm = 1e-5\n")),
                "primitives.close_carry.filled_N = 0.7 is not between 0.21 N, what the bag weighs, "
                "and 0.60 N");
  ExpectRefused(render("bag2 --set primitives.close_carry.filled_N=0.15"),
                "--set: primitives.close_carry.filled_N = 0.15 is not between 0.19 N");
  ExpectRefused(render(bag("[bag]\nthicknes_m = 0.001\n")), "did you mean bag.thickness_m?");
  ExpectRefused(render("bag1") + " --set bag.friction_cube=2",
                "--set: bag.friction_cube = 2 is not within [0.2, 0.8]");
  EXPECT_FALSE(fs::exists(dir_ / "frames"));
}

// What lies in a run's folder or an older corpus's is not written over.
TEST_F(Cli, RenderLeavesFoldersAloneThatHoldSomething) {
  for (const char* name : {"config.toml", "labels.jsonl"}) {
    const fs::path folder = dir_ / (std::string("of_") + name);
    fs::create_directory(folder);
    WriteFileAtomic(folder / name, "kept");
    ExpectRefused("render --state s1 --out " + folder.string(),
                  std::string("has a ") + name + " already");
    EXPECT_EQ(ReadFile(folder / name), "kept");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1);
  }
}

TEST_F(Cli, CamerasThatDoNotExistAreRefused) {
  const std::string render = "render --state s1 --out " + (dir_ / "frames").string();
  ExpectRefused(render + " --set sensor.preset=kinect",
                "--set: sensor.preset = \"kinect\" is not one of \"realsense\", \"clean\"");
  ExpectRefused(render + " --set light.red=nan", "--set: light.red = nan is not within [0.5, 2]");
  const fs::path config = Write("c.toml", "[sensor]\nedge_step_mm = -1\n[variation]\namount = 2\n");
  ExpectRefused(render + " --config " + config.string(),
                "c.toml:2: sensor.edge_step_mm = -1 is not within [0, 1000]");
  ExpectRefused(render + " --config " + config.string() + " --set sensor.edge_step_mm=0",
                "c.toml:4: variation.amount = 2 is not within [0, 1]");
  ExpectRefused(render + " --vary --set variation.clutter=1.5",
                "variation.clutter = 1.5 must be a whole number");
  EXPECT_FALSE(fs::exists(dir_ / "frames"));
}

TEST_F(Cli, BrokenImagesAreRefusedByName) {
  cv::imwrite((dir_ / "dot.png").string(), cv::Mat::zeros(1, 1, CV_8UC3));
  ExpectRefused("classify " + (dir_ / "dot.png").string(), "dot.png: is 1x1 pixels");
  cv::imwrite((dir_ / "whole.png").string(), cv::Mat::zeros(480, 640, CV_8UC3));
  const std::string whole = " " + (dir_ / "whole.png").string();
  ExpectRefused("classify --crop 0,0,700,340" + whole, "is not within the image's 640x480");
  ExpectRefused("classify --crop 0,0,10,340" + whole, "--crop: 0,0,10,340 has a side below 32");
  for (const char* crop : {"0,0,340", "0,0,340,340,1", "0,0,a,340", "0;0;340;340"}) {
    ExpectRefused("classify --crop '" + std::string(crop) + "'" + whole, "is not x,y,width,height");
  }
  ExpectRefused("classify", "images");
  ExpectRefused("classify /nowhere.png", "/nowhere.png");
  ExpectRefused("classify " + Write("a.png", "not a picture").string(), "a.png");
  ExpectRefused("classify " + Write("b.png", "").string(), "b.png");
  ExpectRefused("classify " + dir_.string(), dir_.string());
  ExpectRefused("classify --corpus " + dir_.string(), "labels.jsonl");
  ExpectRefused("classify a.png --px-per-m 0", "--px-per-m");
  ExpectRefused("classify a.png --camera " + Write("c.json", "{}").string(), "c.json");
  ExpectRefused("classify --calibrate a.png", "--bag");
  ExpectRefused("classify --set perception.cube_min=3 a.png", "unknown key perception.cube_min");
}

// libjpeg and libpng would fill what is missing with grey.
TEST_F(Cli, HalfAnImageIsRefused) {
  cv::Mat noise(480, 640, CV_8UC3);
  cv::randu(noise, 0, 255);
  for (const char* name : {"a.jpg", "a.png"}) {
    const fs::path file = dir_ / name;
    cv::imwrite(file.string(), noise);
    EXPECT_EQ(Gusset("classify " + file.string()).code, 0);
    EXPECT_EQ(Gusset("classify " + file.string()).err, "");
    fs::resize_file(file, fs::file_size(file) / 2);
    ExpectRefused("classify " + file.string(), std::string(name) + ": is cut off");
  }
}

// What libpng, libjpeg and OpenCV say themselves would be further lines.
TEST_F(Cli, ADamagedImageIsRefusedInOneLine) {
  cv::Mat noise(480, 640, CV_8UC3);
  cv::randu(noise, 0, 255);
  for (const char* name : {"a.jpg", "a.png", "a.bmp"}) {
    const fs::path file = dir_ / name;
    cv::imwrite(file.string(), noise);
    const std::string whole = ReadFile(file);
    const std::size_t third = whole.size() / 3;
    WriteFileAtomic(file, whole.substr(0, third) + whole.substr(2 * third));
    ExpectRefused("classify " + file.string(), std::string(name) + ": is ");
  }
}

TEST_F(Cli, NothingGivenIsOverwritten) {
  for (const char* folder : {"a", "b"}) {
    fs::create_directory(dir_ / folder);
    cv::imwrite((dir_ / folder / "x.png").string(), cv::Mat::zeros(480, 640, CV_8UC3));
  }
  const std::string a = (dir_ / "a/x.png").string(), b = (dir_ / "b/x.png").string();
  ExpectRefused("classify " + a + " " + b + " --out " + dir_.string(), "would both become x_ov");
  ExpectRefused("report " + dir_.string() + " --out " + a, "does not end in .html");
  const std::string policy = Write("p.json", "{}").string();
  ExpectRefused("evaluate --policy " + policy + " --out " + policy, "is not a result of this");
  EXPECT_EQ(Slurp(policy), "{}");
  Write("steps.jsonl", "{}\n{}\n");
  ExpectRefused("evaluate --policy random --out " + (dir_ / "steps.jsonl").string(),
                "is not a res");
  EXPECT_EQ(Slurp(dir_ / "steps.jsonl"), "{}\n{}\n");
  ExpectRefused("train --out " + dir_.string(), "steps.jsonl: is of a run whose config.toml");
}

TEST_F(Cli, AFolderThatAnotherProcessWorksInIsLeftAlone) {
  const FolderLock lock(dir_);
  ExpectRefused("train --out " + dir_.string(), "another process is working there");
  ExpectRefused("experiment thesis --out " + dir_.string(), "another process is working there");
}

TEST_F(Cli, APolicyWithoutItsRunHasItsBag) {
  const fs::path policy = fs::path(GUSSET_SOURCE_DIR) / "assets/policies/pi100-seed1.json";
  std::string text = Slurp(policy);
  const std::string bag = R"("bag": "bag1")";
  const std::size_t at = text.find(bag);
  ASSERT_NE(at, std::string::npos);
  const fs::path other = Write("p.json", text.replace(at, bag.size(), R"("bag": "bag7")"));
  const std::string out = " --out " + (dir_ / "x").string();
  ExpectRefused("play --policy " + other.string() + out, "p.json: bag: no bag is called bag7");
}

TEST_F(Cli, AFilmThatCannotBeWrittenIsRefusedInOneLine) {
  fs::create_directories(dir_ / "q/episode.mp4");
  ExpectRefused("play --policy random --out " + (dir_ / "q").string(), "episode.mp4: cannot write");
}

TEST_F(Cli, ValuesThatFindNothingOrWrapAreRefused) {
  ExpectRefused("classify a.png --set perception.bag_hsv_min=[0,200,45]",
                "perception.bag_hsv_min = 200 is above bag_hsv_max's = 107");
  ExpectRefused("classify a.png --set perception.label_hsv_min=[200,0,0]", "is no hue");
  ExpectRefused("classify a.png --set perception.depth_window_px=4", "= 4 is not odd");
  ExpectRefused("classify a.png --set perception.roi_x=600", "perception.roi_x = 600 is more than");
  for (const char* command : {"evaluate --policy random", "play --policy random --out o"}) {
    ExpectRefused(std::string(command) + " --seed -1", "--seed");
    ExpectRefused(std::string(command) + " --seed 99999999999999999999", "--seed");
  }
  ExpectRefused("play --run r --start unfolded --out o", "--start");
  ExpectRefused("train --out \"\"", "--out: its value is empty");
  ExpectRefused("evaluate --policy random --out ''", "--out: its value is empty");
  ExpectRefused("experiment thesis --set ''", "--set: its value is empty");
  ExpectRefused("bag --out x", "not expected: bag ");
}

TEST_F(Cli, WhatCannotBePrintedIsAFailure) {
  const fs::path file = dir_ / "a.png";
  cv::imwrite(file.string(), cv::Mat::zeros(480, 640, CV_8UC3));
  for (const std::string& arguments :
       {"classify " + file.string(), "classify --json " + file.string(), std::string("--help")}) {
    const std::string command =
        std::string(GUSSET_BINARY) + " " + arguments + " >/dev/full 2>" + (dir_ / "err").string();
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
    EXPECT_EQ(Slurp(dir_ / "err"), "gusset: cannot write to standard output\n");
  }
  // Nobody reads any more.
  const std::string code = (dir_ / "code").string();
  const std::string piped = "(sleep 0.2; " + std::string(GUSSET_BINARY) + " --help 2>" +
                            (dir_ / "err").string() + "; echo $? >" + code + ") | true";
  EXPECT_EQ(std::system(("bash -c '" + piped + "'").c_str()), 0);
  EXPECT_EQ(Slurp(code), "1\n");
  EXPECT_EQ(Slurp(dir_ / "err"), "gusset: cannot write to standard output\n");
}

TEST_F(Cli, BrokenCorporaAreRefusedWithFileAndLine) {
  const std::string corpus = "classify --corpus " + dir_.string();
  const auto label = [&](const std::string& line) { Write("labels.jsonl", line + "\n"); };
  label("");
  ExpectRefused(corpus, "labels.jsonl:1");
  label("{\"file\": \"a.png\"}");
  ExpectRefused(corpus, "labels.jsonl:1: state is missing");
  label("{\"file\": \"a.png\", \"state\": \"s7\"}");
  ExpectRefused(corpus, "state = s7");
  label("{\"file\": \"a.png\", \"state\": \"s1\", \"A_bag\": -1, \"A_o\": 0, \"labels\": 5}");
  ExpectRefused(corpus, "A_bag = -1 is not within [0");
  label("{\"file\": \"a.png\", \"state\": \"s1\", \"cube_m\": [0, 0]}");
  ExpectRefused(corpus, "cube_m");
  label(
      R"({"file": "a.png", "state": "s1", "label_px2": [9], "label_centre_px": [[1, 2], [3, 4]]})");
  ExpectRefused(corpus, "label_px2 = [9] must have 2 elements");
  label(R"({"file": "a.png", "state": "s1", "label_px2": [9], "label_centre_px": [[1]]})");
  ExpectRefused(corpus, "label_centre_px[0] = [1] must have 2 elements");
  label("{\"file\": \"a.png\", \"state\": \"s1\"}");
  ExpectRefused(corpus, "a.png: cannot be read");
  Write("a.png", "cut short");
  ExpectRefused(corpus, "a.png: is not an image");
  Write("camera.json", "{\"width\": 640, \"height\": 480, \"K\": [[1, 2, 3]]}");
  ExpectRefused(corpus, "camera.json: K must have 3 rows");
  const auto camera = [&](const std::string& k, const std::string& last) {
    Write("camera.json", "{\"width\": 640, \"height\": 480, \"K\": [" + k +
                             "], \"X_WC\": [[1, 0, 0, 0], [0, -1, 0, 0], [0, 0, -1, 1], " + last +
                             "]}");
  };
  camera("[615, 1, 320], [0, 615, 240], [0, 0, 1]", "[0, 0, 0, 1]");
  ExpectRefused(corpus, "camera.json: K[0][1] must be 0");
  camera("[615, 0, 320], [0, 615, 240], [0, 0, 2]", "[0, 0, 0, 1]");
  ExpectRefused(corpus, "camera.json: K[2] must be [0, 0, 1]");
  camera("[-615, 0, 320], [0, 615, 240], [0, 0, 1]", "[0, 0, 0, 1]");
  ExpectRefused(corpus, "camera.json: K[0][0] and K[1][1] must be 1 px or more");
  camera("[615, 0, 320], [0, 615, 240], [0, 0, 1]", "[0, 0, 1, 1]");
  ExpectRefused(corpus, "camera.json: X_WC[3] must be [0, 0, 0, 1]");
  Write("camera.json", "{\"width\": 0}");
  ExpectRefused(corpus, "camera.json: width = 0 is not within [1");
}

// Nobody waits for random actions to succeed: the bag is taken away, the cube lies beside.
TEST_F(Cli, RendersClearedTablesOfWhichNoTwoAreAlike) {
  const fs::path out = dir_ / "cleared";
  ASSERT_EQ(Gusset("render --state s4 --count 3 --vary --out " + out.string()).code, 0);
  std::istringstream lines(Slurp(out / "labels.jsonl"));
  std::set<double> places;
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json label = nlohmann::json::parse(line);
    EXPECT_EQ(label.at("state"), "s4");
    EXPECT_GT(label.at("cube_px").get<int>(), 0) << "in the frame";
    EXPECT_GT(std::abs(label.at("cube_m")[0].get<double>()), 0.3) << "beside the region";
    places.insert(label.at("cube_m")[0].get<double>());
  }
  EXPECT_EQ(places.size(), 3u);
  EXPECT_TRUE(fs::exists(out / "s4_00000_masks.png"));
}

// Rendered bags laid flat, anywhere near the middle. 3 % is what a state may be off by.
TEST_F(Cli, CalibratingWritesTheBagsFileAndNothingElseOfIt) {
  const fs::path source = fs::path(GUSSET_SOURCE_DIR) / "assets/bags/bag1.toml";
  std::string given = Slurp(source);
  given.replace(given.find("A_th = 25000"), 12, "A_th = 9000  # not yet");
  const fs::path bag = Write("new.toml", given);
  const std::string flat = (dir_ / "flat").string();
  ASSERT_EQ(Gusset("render --state s1 --count 4 --seed 5 --out " + flat).code, 0);
  const Result result =
      Gusset("classify --calibrate --json --bag " + bag.string() + " --corpus " + flat);
  ASSERT_EQ(result.code, 0) << result.err;
  const nlohmann::json found = nlohmann::json::parse(result.out);
  EXPECT_NEAR(found.at("A_th").get<double>(), 25000, 0.03 * 25000);
  EXPECT_NEAR(found.at("A_oth").get<double>(), 700, 0.03 * 700);
  EXPECT_NEAR(found.at("A_bmax").get<double>(), 34000, 0.03 * 34000);
  EXPECT_NEAR(found.at("A_omax").get<double>(), 3900, 0.03 * 3900);
  EXPECT_NEAR(found.at("A_flat").get<double>(), 34950, 0.03 * 34950);
  std::string copies;
  for (int i = 0; i < 3; ++i) copies += " " + (fs::path(flat) / "s1_00000.png").string();
  ExpectRefused("classify --calibrate --bag " + bag.string() + copies, "at least 3 must");
  const std::string text = Slurp(bag);
  EXPECT_THAT(text, HasSubstr("# Bag 1: cotton tote."));
  EXPECT_THAT(text, HasSubstr("[thresholds_published]\nA_th = 25000\n"));
  EXPECT_THAT(text, HasSubstr("# not yet"));
  EXPECT_EQ(Gusset("classify --corpus " + flat + " --bag " + bag.string()).code, 0);
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

TEST_F(Cli, AnExperimentThatCannotBeIsRefusedBeforeAnyWork) {
  const std::string out = " --out " + (dir_ / "e").string();
  ExpectRefused("experiment", "subcommand");
  ExpectRefused("experiment thesis --only 5.3" + out, "there are: 5.4, 5.5, 5.6");
  ExpectRefused("experiment thesis --agents pi20" + out, "there is no pi20");
  ExpectRefused("experiment thesis --seeds 0" + out, "--seeds = 0 is not within [1, ");
  ExpectRefused("experiment thesis --jobs 0" + out, "--jobs");
  ExpectRefused("experiment thesis --agents pi10 --set pi.epsilon_min=2" + out,
                "pi.epsilon_min = 2 is not within [0, 1]");
  ExpectRefused("experiment thesis --set train.steps=5" + out, "= 5 is the grid's to set");
  ExpectRefused("experiment thesis --set ' train.seed = 5'" + out, "= 5 is the grid's to set");
  const std::string config = Write("c.toml", "\n[train]\nagent = 'dqn'\n").string();
  ExpectRefused("experiment thesis --config " + config + out, "c.toml:3: train.agent = \"dqn\" is");
  ExpectRefused("experiment thesis --list --set no.key=1", "no.key");
  ExpectRefused("experiment thesis --list --json", "--list");
  ExpectRefused("experiment thesis --resume" + out, "holds no experiment");
  EXPECT_FALSE(fs::exists(dir_ / "e"));
  fs::create_directory(dir_ / "e");
  Write("e/results.csv", "");
  ExpectRefused("experiment thesis" + out, "holds an experiment already");
}

TEST_F(Cli, AnExperimentCanBeListedWithoutBeingDone) {
  const Result result = Gusset("experiment thesis --full --list");
  EXPECT_EQ(result.code, 0);
  EXPECT_EQ(result.err, "");
  EXPECT_THAT(result.out, HasSubstr("pi100-any_pose"));
  EXPECT_THAT(result.out, HasSubstr("train.affordances=false"));
}

TEST_F(Cli, ARunFolderThatIsNoneIsRefused) {
  ExpectRefused("train --resume --out " + dir_.string(), "config.toml");
  ExpectRefused("play --run " + dir_.string() + " --step 0 --out " + (dir_ / "x").string(),
                "steps.jsonl");
  ExpectRefused("evaluate --policy " + dir_.string(), "policy.json");
  const std::string page = " --out " + (dir_ / "r.html").string();
  ExpectRefused("report " + dir_.string() + page, "holds neither a run");
  ExpectRefused("report /nowhere" + page, "/nowhere: is not a folder");
  Write("results.csv", "table\n");
  ExpectRefused("report " + dir_.string() + page, "results.csv:1: column row is missing");
  ExpectRefused("evaluate --policy " + Write("p.json", "{").string(), "p.json");
  const std::string out = (dir_ / "x").string();
  ExpectRefused("play --policy " + (dir_ / "p.json").string() + " --out " + out, "p.json");
  EXPECT_FALSE(fs::exists(out)) << "nothing to look at was left";
  Write("config.toml", "");
  const std::string play = "play --run " + dir_.string() + " --out " + out + " --step ";
  const auto line = [](int step, int state, int action) {
    const nlohmann::json json = {{"step", step},
                                 {"state", state},
                                 {"action", action},
                                 {"sensor_seed", 1},
                                 {"from", {{"seed", 1}}}};
    return json.dump() + "\n";
  };
  Write("steps.jsonl", line(0, 0, 81) + line(1, 7, 0));
  ExpectRefused(play + "0", "steps.jsonl:1: action");
  ExpectRefused(play + "1", "steps.jsonl:2: state");
  Write("x/action00.json", "{\"before\": {}, \"after\": {}}");
  ExpectRefused(play + "2", "has 2 steps");
  EXPECT_TRUE(fs::exists(dir_ / "x/action00.json")) << "what is refused removes nothing";
}

}  // namespace
}  // namespace gusset
