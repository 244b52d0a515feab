#include "tools/gusset/sim_referee.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/sim/render_bag.h"

namespace gusset {
namespace {

// A heap of folds, which hides parts of itself. The heap is above the table everywhere, so that
// depth tells it from the canvas.
TEST(SimReferee, TheBagIsAsLargeAsTheCleanPictureShowsIt) {
  const SimConfig config;
  SimScene scene(config);
  ClothItem heap = CrumpledBag();
  ClothState state = scene.world().cloth().state();
  ASSERT_EQ(state.x.size(), heap.x.size());
  for (std::size_t n = 0; n < heap.x.size(); ++n) {
    state.x[n] = heap.x[n] + Eigen::Vector3f(0, 0, 0.03f);
  }
  scene.world().cloth().SetState(std::move(state));
  SimReferee referee(scene, PerceptionConfig(), BagThresholds());
  const FrameTruth truth = referee.Describe();

  const PerceptionConfig perception;
  const cv::Rect roi(perception.roi_x, perception.roi_y, perception.roi_side, perception.roi_side);
  const cv::Mat depth_mm = scene.Look(scene.model()).depth_mm(roi);
  const int above_table = cv::countNonZero(depth_mm < 1000 * config.camera.height_m - 5);
  ASSERT_GT(above_table, 3000);
  // Drawn by another rasteriser: pixels whose centres lie on an edge may differ.
  EXPECT_NEAR(truth.truth.bag_area_px2, above_table, 0.002 * above_table);
}

// By pixel centres alone a label of 56 px^2 is up to 4 % smaller or larger, as it happens to lie.
TEST(SimReferee, LabelsAreToldTwoPercentSmallerOrLargerThanALimit) {
  const SimConfig config;
  SimScene scene(config);
  const ClothState flat = scene.world().cloth().state();
  for (int k = 0; k < 8; ++k) {
    ClothState state = flat;
    const float part = static_cast<float>(k) / 8;
    const Eigen::Matrix3f turned =
        Eigen::AngleAxisf(0.1f + part, Eigen::Vector3f::UnitZ()).toRotationMatrix();
    float top_m = 0;
    for (Eigen::Vector3f& x : state.x) {
      x = turned * x + Eigen::Vector3f(0.003f * part, 0.002f * part, 0.002f);
      top_m = std::max(top_m, x.z());
    }
    top_m += 0.5f * static_cast<float>(config.bag.thickness_m);
    scene.world().cloth().SetState(std::move(state));
    const double px_per_m = scene.model().pinhole.fx / (config.camera.height_m - top_m);
    const double label_px2 =
        config.bag.label_width_m * config.bag.label_height_m * px_per_m * px_per_m;
    PerceptionConfig perception;
    perception.label_min_px2 = 0.98 * label_px2;
    EXPECT_EQ(SimReferee(scene, perception, BagThresholds()).Describe().labels_seen,
              config.bag.labels_per_layer);
    perception.label_min_px2 = 1.02 * label_px2;
    EXPECT_EQ(SimReferee(scene, perception, BagThresholds()).Describe().labels_seen, 0);
  }
}

}  // namespace
}  // namespace gusset
