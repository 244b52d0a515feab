#include "perception/depth.h"

#include <gtest/gtest.h>

#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

const PerceptionConfig kConfig;

View ViewOf(const RgbdFrame& frame) { return MakeView(frame, synthetic::Camera(), kConfig); }

TEST(MedianDepth, IgnoresWhatIsNoMeasurement) {
  EXPECT_EQ(MedianDepth({0, 0, 1066, 40, 9000, 1060, 1070}, kConfig), 1066);
  EXPECT_EQ(MedianDepth({}, kConfig), std::nullopt);
  EXPECT_EQ(MedianDepth({0, 20, 60000}, kConfig), std::nullopt);
}

TEST(MedianDepth, OfTwoSurfacesItIsOneOfThem) {
  EXPECT_EQ(MedianDepth({1066, 1066, 1031, 1031}, kConfig), 1031);
}

TEST(Deproject, GivesTheWorldPointOfTheSurface) {
  RgbdFrame frame = synthetic::EmptyTable();
  frame.depth_mm = 1056;  // 10 mm above the table.
  const PosePoint point = Deproject(ViewOf(frame), {420, 300}, kConfig);
  EXPECT_TRUE(point.from_depth);
  const Eigen::Vector3d p_W(100. / 615 * 1.056, -60. / 615 * 1.056, 0.010);
  EXPECT_LT((point.p_W - p_W).norm(), 1e-12);
}

TEST(Deproject, HolesAndSpikesDoNotMatter) {
  RgbdFrame frame = synthetic::EmptyTable();
  for (int k = 0; k < 10; ++k) {
    frame.depth_mm.at<std::uint16_t>(298 + k / 5, 418 + k % 5) = k % 2 == 0 ? 0 : 700;
  }
  const PosePoint point = Deproject(ViewOf(frame), {420, 300}, kConfig);
  EXPECT_NEAR(point.p_W.z(), 0, 1e-12);
}

// The median of 25 depths with 2 mm of noise: sigma 0.5 mm; four of those.
TEST(Deproject, AveragesSensorNoise) {
  RgbdFrame frame = synthetic::EmptyTable();
  Rng rng(5);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      frame.depth_mm.at<std::uint16_t>(y, x) =
          static_cast<std::uint16_t>(std::lround(1066 + 2 * rng.Normal()));
    }
  }
  for (int x = 160; x < 480; x += 40) {
    EXPECT_NEAR(Deproject(ViewOf(frame), cv::Point2d(x, 240), kConfig).p_W.z(), 0, 0.002);
  }
}

TEST(Deproject, WithoutDepthThePointLiesOnTheTableAndIsMarked) {
  RgbdFrame frame = synthetic::EmptyTable();
  const Eigen::Vector3d p_W = Deproject(ViewOf(frame), {420, 300}, kConfig).p_W;
  frame.depth_mm = 0;
  const PosePoint zero = Deproject(ViewOf(frame), {420, 300}, kConfig);
  frame.depth_mm = cv::Mat();
  const PosePoint none = Deproject(ViewOf(frame), {420, 300}, kConfig);
  for (const PosePoint& point : {zero, none}) {
    EXPECT_FALSE(point.from_depth);
    EXPECT_LT((point.p_W - p_W).norm(), 1e-12);
  }
}

TEST(Deproject, WorksAtTheEdgeOfTheFrameAndBeyondIt) {
  const View view = ViewOf(synthetic::EmptyTable());
  EXPECT_TRUE(Deproject(view, {0, 0}, kConfig).from_depth);
  EXPECT_FALSE(Deproject(view, {-20, 700}, kConfig).from_depth);
}

TEST(OntoLevel, IsFiniteEvenForARayAlongThePlane) {
  View view = ViewOf(synthetic::EmptyTable());
  view.camera.X_WC.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;  // Looks along world x.
  EXPECT_TRUE(OntoLevel(view, {320, 240}, 0).allFinite());
}

}  // namespace
}  // namespace gusset
