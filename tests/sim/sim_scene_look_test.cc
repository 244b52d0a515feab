// What the camera port shows of a scene, with and without noise and variation.

#include <gtest/gtest.h>

#include <opencv2/core.hpp>

#include "base/error.h"
#include "sim/sim_scene.h"

namespace gusset {
namespace {

SimConfig CleanConfig() {
  SimConfig config;
  config.sensor.preset = "clean";
  return config;
}

/// The first look at the same world under `config`.
RgbdFrame FirstLook(const SimConfig& config, std::uint64_t sensor_seed = 5) {
  SimScene scene(config);
  scene.Reset(StartKind::kUnfolded, 2);
  scene.Restore(scene.Save(), sensor_seed);
  return scene.Look();
}

bool Same(const RgbdFrame& a, const RgbdFrame& b) {
  return cv::norm(a.color, b.color, cv::NORM_INF) == 0 &&
         cv::norm(a.depth_mm, b.depth_mm, cv::NORM_INF) == 0;
}

TEST(SimSceneLook, PresetCleanIsTheRenderersFrameToTheBit) {
  SimScene scene(CleanConfig());
  scene.Reset(StartKind::kUnfolded, 2);
  EXPECT_TRUE(Same(scene.Look(), scene.Look(scene.model())));
}

TEST(SimSceneLook, VariationOfAmountZeroChangesNoBit) {
  SimConfig none;
  none.variation.seed = 9;
  none.variation.camera_mm = 50;
  EXPECT_TRUE(Same(FirstLook(none), FirstLook({})));
}

TEST(SimSceneLook, VariationFollowsItsSeedsAndIsNotToldToPerception) {
  SimConfig config = CleanConfig();
  config.variation.amount = 1;
  const RgbdFrame varied = FirstLook(config);
  EXPECT_TRUE(Same(varied, FirstLook(config)));
  EXPECT_FALSE(Same(varied, FirstLook(config, 6)));
  EXPECT_FALSE(Same(varied, FirstLook(CleanConfig())));

  SimScene plain({}), scene(config);
  scene.Reset(StartKind::kUnfolded, 2);
  scene.Restore(scene.Save(), 5);
  EXPECT_EQ(scene.model().X_WC.matrix(), plain.model().X_WC.matrix());
}

// The table seen by a camera that is at most 3 mm and 1 degree off: its distance changes by 3 mm,
// and by the tilt's 0.55 m * tan(1 degree) = 10 mm at the image's sides; clutter stands 40 mm high.
TEST(SimSceneLook, AVariedCameraSeesTheTableWithinItsBounds) {
  SimConfig config = CleanConfig();
  config.variation.amount = 1;
  config.variation.clutter = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const cv::Mat depth = FirstLook(config, seed).depth_mm;
    EXPECT_NEAR(depth.at<std::uint16_t>(40, 320), 1066, 3 + 0.36 * 17.5 + 1);
    EXPECT_NEAR(depth.at<std::uint16_t>(240, 20), 1067, 3 + 0.55 * 17.5 + 1);
  }
}

// 16 x 18 and 22 x 13 nodes a layer are both 526 in all, but lie in other rows.
TEST(SimScene, RefusesSnapshotsOfAnotherMesh) {
  SimConfig config;
  SimScene scene(config);
  scene.Reset(StartKind::kUnfolded, 2);
  config.bag.nodes_across = 22;
  config.bag.nodes_deep = 13;
  SimScene other(config);
  other.Reset(StartKind::kUnfolded, 2);
  ASSERT_EQ(other.world().cloth().state().x.size(), scene.world().cloth().state().x.size());
  EXPECT_THROW(scene.Restore(other.Save(), 5), InputError);
  EXPECT_NO_THROW(scene.Restore(scene.Save(), 5));
}

TEST(SimScene, AResetIsTheSameWhateverRanBefore) {
  SimConfig config;
  config.variation.amount = 1;
  SimScene fresh(config);
  fresh.Reset(StartKind::kUnfolded, 2);
  const RgbdFrame look = fresh.Look();
  SimScene used(config);
  used.Reset(StartKind::kUnfolded, 3);
  used.Restore(used.Save(), 5);
  used.Look();
  used.Reset(StartKind::kUnfolded, 2);
  EXPECT_TRUE(Same(used.Look(), look));
  EXPECT_EQ(used.labels().size(), fresh.labels().size());
}

}  // namespace
}  // namespace gusset
