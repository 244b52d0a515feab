#include "tools/gusset/sim_referee.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "tests/sim/render_bag.h"

namespace gusset {
namespace {

// A heap of folds of 20 mm nodes: flat triangles through them have another outline than what is
// drawn. The heap is above the table everywhere, so that depth tells it from the canvas.
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

}  // namespace
}  // namespace gusset
