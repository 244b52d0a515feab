// What a bag's file may say: impossible bags are refused before anything is built, in one line with
// file, line, key, value and bound.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "sim/sim_scene.h"

namespace gusset {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// What reading a bag's file with these lines says; the first is on line 2.
std::string ErrorOf(const std::string& lines, const std::string& other_sections = "") {
  ConfigTree tree;
  tree.Parse("[bag]\n" + lines + "\n" + other_sections, "my.toml");
  SimConfig config;
  try {
    config.Read(tree);
  } catch (const InputError& e) {
    const std::string what = e.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }
  return "no error";
}

TEST(BagFile, EveryBagOfTheAssetsIsAccepted) {
  int bags = 0;
  for (const auto& entry : std::filesystem::directory_iterator(
           std::filesystem::path(GUSSET_SOURCE_DIR) / "assets" / "bags")) {
    ConfigTree tree;
    tree.Load(entry.path());
    SimConfig config;
    EXPECT_NO_THROW(config.Read(tree)) << entry.path();
    EXPECT_EQ(config.bag.name, entry.path().stem());
    ++bags;
  }
  EXPECT_GE(bags, 5);
  EXPECT_EQ(ErrorOf(""), "no error");
}

struct Impossible {
  const char* line;
  const char* error;
};

class ImpossibleBag : public testing::TestWithParam<Impossible> {};

TEST_P(ImpossibleBag, IsRefusedWithLineKeyValueAndBound) {
  EXPECT_EQ(ErrorOf(GetParam().line), std::string("my.toml:2: bag.") + GetParam().error);
}

INSTANTIATE_TEST_SUITE_P(
    Values, ImpossibleBag,
    testing::Values(
        Impossible{"opening_m = -0.3", "opening_m = -0.3 is not within [0.1, 1]"},
        Impossible{"opening_m = 0", "opening_m = 0 is not within [0.1, 1]"},
        Impossible{"depth_m = nan", "depth_m = nan is not within [0.1, 1]"},
        Impossible{"depth_m = inf", "depth_m = inf is not within [0.1, 1]"},
        Impossible{"depth_m = 350", "depth_m = 350 is not within [0.1, 1]"},
        Impossible{"thickness_m = 0", "thickness_m = 0 is not within [2e-04, 0.0015]"},
        Impossible{"thickness_m = 0.004", "thickness_m = 0.004 is not within [2e-04, 0.0015]"},
        Impossible{"area_density_kg_m2 = -0.1",
                   "area_density_kg_m2 = -0.1 is not within [0.02, 0.35]"},
        Impossible{"area_density_kg_m2 = 240",
                   "area_density_kg_m2 = 240 is not within [0.02, 0.35]"},
        Impossible{"flexural_rigidity_Nm = 0",
                   "flexural_rigidity_Nm = 0 is not within [1e-07, 2e-04]"},
        Impossible{"flexural_rigidity_Nm = 1e3",
                   "flexural_rigidity_Nm = 1000 is not within [1e-07, 2e-04]"},
        Impossible{"friction_cloth = 1.5", "friction_cloth = 1.5 is not within [0.2, 0.8]"},
        Impossible{"friction_table = -nan", "friction_table = nan is not within [0.2, 0.8]"},
        Impossible{"drag_coefficient = 0", "drag_coefficient = 0 is not within [1, 2]"},
        Impossible{"labels_per_layer = 0", "labels_per_layer = 0 is not within [3, 20]"},
        Impossible{"labels_per_layer = 5.0", "labels_per_layer = 5 must be a whole number"},
        Impossible{"label_width_m = 0", "label_width_m = 0 is not within [0.004, 0.05]"},
        Impossible{"label_height_m = 0.5", "label_height_m = 0.5 is not within [0.004, 0.05]"},
        Impossible{"nodes_across = 2", "nodes_across = 2 is not within [8, 64]"},
        Impossible{"nodes_deep = 9000", "nodes_deep = 9000 is not within [8, 64]"},
        Impossible{"nodes_deep = -18", "nodes_deep = -18 is not within [8, 64]"},
        Impossible{"colour_rgb = [0.9, 0.9]",
                   "colour_rgb = a list of numbers must have 3 "
                   "numbers, not 2"},
        Impossible{"colour_rgb = [0.9, nan, 0.9]", "colour_rgb[1] = nan is not within [0, 1]"},
        Impossible{"opening_m = \"wide\"", "opening_m = \"wide\" must be a number"}));

TEST(BagFile, LabelsWiderThanTheRimAreRefused) {
  EXPECT_EQ(ErrorOf("label_width_m = 0.04\nlabels_per_layer = 8"),
            "my.toml:2: bag.label_width_m = 0.04 is not at most 0.0375: bag.labels_per_layer = 8 "
            "labels do not fit side by side onto bag.opening_m = 0.3");
  EXPECT_EQ(ErrorOf("label_width_m = 0.0375\nlabels_per_layer = 8"), "no error");
}

// A label that a bag's file does not set has no line to name.
TEST(BagFile, ARimTooNarrowForTheUsualLabelsIsRefused) {
  EXPECT_EQ(ErrorOf("opening_m = 0.2\nlabels_per_layer = 20"),
            "bag.label_width_m = 0.012 is not at most 0.01: bag.labels_per_layer = 20 labels do "
            "not fit side by side onto bag.opening_m = 0.2");
}

// Contact cannot tell a ply from its neighbours, or a row from a column.
TEST(BagFile, MeshesFinerThanThePlyOrOfSliversAreRefused) {
  EXPECT_EQ(ErrorOf("opening_m = 0.1\nnodes_across = 64\nnodes_deep = 64\nlabels_per_layer = 3\n",
                    "[starts]\nfolded_area_min_px = 100\n"),
            "my.toml:3: bag.nodes_across = 64 puts nodes 0.0015873 m apart, less than two "
            "bag.thickness_m = 0.0015");
  EXPECT_EQ(ErrorOf("nodes_deep = 64\nnodes_across = 8"),
            "my.toml:2: bag.nodes_deep = 64 puts nodes 0.00555556 m apart, less than a quarter of "
            "the 0.0428571 m of the other direction");
}

TEST(BagFile, ACubeThatWaitsWhereTheBagLiesOrUnseenIsRefused) {
  EXPECT_EQ(ErrorOf("", "[world]\ncube_wait_m = [0, 0.1]\n"),
            "my.toml:4: world.cube_wait_m = 0.1 is where the bag lies, less than 0.315237 m from "
            "the table's middle");
  EXPECT_EQ(ErrorOf("", "[world]\ncube_wait_m = [0, 0.31]\n"),
            "my.toml:4: world.cube_wait_m = 0.31 is where the bag lies, less than 0.315237 m from "
            "the table's middle");
  EXPECT_EQ(ErrorOf("", "[world]\ncube_wait_m = [0.23, 0.23]\n"), "no error");
  EXPECT_EQ(ErrorOf("", "[world]\ncube_wait_m = [0, -0.44]\n"),
            "my.toml:4: world.cube_wait_m = -0.44 is out of the camera's view, which ends 0.381 m "
            "from its middle");
  EXPECT_EQ(ErrorOf("", "[world]\ncube_wait_m = [-0.42, 0]\n"), "no error");
}

TEST(BagFile, StartsThatABagCannotCoverAreRefused) {
  EXPECT_EQ(ErrorOf("opening_m = 0.15\ndepth_m = 0.1\nflexural_rigidity_Nm = 1e-6",
                    "[starts]\nfolded_area_min_px = 6000\nfolded_area_max_px = 9000\n"),
            "my.toml:6: starts.folded_area_min_px = 6000 is not below the 4993 px that a bag of "
            "bag.opening_m = 0.15, bag.depth_m = 0.1 covers laid flat");
  EXPECT_EQ(ErrorOf("", "[starts]\nfolded_area_min_px = 9000\nfolded_area_max_px = 9000\n"),
            "my.toml:4: starts.folded_area_min_px = 9000 is not below starts.folded_area_max_px = "
            "9000");
}

}  // namespace
}  // namespace gusset
