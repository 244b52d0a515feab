#include "tools/gusset/settings.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "base/error.h"
#include "base/files.h"
#include "tests/temporary_folder.h"

namespace gusset {
namespace {

// Bag 2's file says how far to drag, Bag 1's does not.
TEST(Settings, ARunsBagLeavesNothingBehindForAnotherBag) {
  CommonOptions common;
  common.assignments = {"primitives.pick_place.widen_m=0.04"};
  const Settings run = LoadSettings(common, {.bag = "bag2"});
  ASSERT_NE(run.bagging.scratch_drag.drag_m, ScratchDragConfig().drag_m);
  const TemporaryFolder folder;
  const std::filesystem::path config = folder.path() / "config.toml";
  WriteFileAtomic(config, run.resolved);

  const Settings same = LoadSettings({}, {.base = config, .bag = "bag2"});
  EXPECT_EQ(same.resolved, run.resolved);
  const Settings other = LoadSettings({}, {.base = config, .bag = "bag1"});
  EXPECT_EQ(other.bagging.scratch_drag.drag_m, ScratchDragConfig().drag_m);
  EXPECT_EQ(other.bagging.pick_place.slit_m, PickPlaceConfig().slit_m);
  EXPECT_EQ(other.bagging.pick_place.widen_m, 0.04) << "the run's own choice";
}

// It would train with one bag's cloth under another's name.
TEST(Settings, AConfigsBagIsTakenWithItsName) {
  const Settings run = LoadSettings({}, {.bag = "bag2"});
  const TemporaryFolder folder;
  CommonOptions common;
  common.config_files = {(folder.path() / "config.toml").string()};
  WriteFileAtomic(common.config_files.front(), run.resolved);
  EXPECT_EQ(LoadSettings(common, {}).resolved, run.resolved);
  EXPECT_EQ(LoadSettings(common, {.bag = "bag2"}).resolved, run.resolved);
  EXPECT_THROW(LoadSettings(common, {.bag = "bag1"}), InputError);
  const std::filesystem::path of_bag1 = folder.path() / "bag1.toml";
  WriteFileAtomic(of_bag1, LoadSettings({}, {.bag = "bag1"}).resolved);
  EXPECT_THROW(LoadSettings(common, {.base = of_bag1}), InputError) << "--config of bag2";
  EXPECT_NO_THROW(LoadSettings(common, {.base = of_bag1, .bag = "bag2"}));
  common.config_files.clear();
  common.assignments = {"train.bag=bag2"};
  EXPECT_EQ(LoadSettings(common, {}).resolved, run.resolved);
}

// What is said as it was already is no change, however it is spelt.
TEST(ChangesBy, AreTheValuesThatDifferFromTheRuns) {
  const SettingsSource source = {.bag = "bag2"};
  CommonOptions common;
  common.assignments = {"sensor.color_sigma=1.50", "sensor.preset=clean", "train.steps=7"};
  EXPECT_EQ(ChangesBy(common, source, LoadSettings(common, source)),
            std::vector<std::string>{"sensor.preset = \"clean\""});
  // Random choice acts with the bag that --config names; that is no change of its settings.
  CommonOptions other;
  other.assignments = {"train.bag=bag2", "pi.update=last", "train.affordances=false"};
  EXPECT_EQ(ChangesBy(other, {}, LoadSettings(other, {})),
            std::vector<std::string>{"train.affordances = false"});
  const TemporaryFolder folder;
  CommonOptions same;
  same.config_files = {(folder.path() / "config.toml").string()};
  WriteFileAtomic(same.config_files.front(), LoadSettings({}, source).resolved);
  EXPECT_TRUE(ChangesBy(same, source, LoadSettings(same, source)).empty());
}

}  // namespace
}  // namespace gusset
