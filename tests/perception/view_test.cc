#include "perception/view.h"

#include <gtest/gtest.h>

#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

const PerceptionConfig kConfig;

RgbdFrame Blank(int width, int height) {
  return {cv::Mat::zeros(height, width, CV_8UC3), cv::Mat::zeros(height, width, CV_16UC1)};
}

TEST(View, AFullFrameIsTakenAsItIs) {
  const RgbdFrame frame = synthetic::EmptyTable();
  const View view = MakeView(frame, synthetic::Camera(), kConfig);
  EXPECT_TRUE(view.has_surroundings);
  EXPECT_FALSE(view.scaled);
  EXPECT_EQ(view.frame.color.data, frame.color.data);
  EXPECT_EQ(view.roi, cv::Rect(150, 70, 340, 340));
}

TEST(View, ABareRegionHasItsOwnOrigin) {
  const View view = MakeView(Blank(340, 340), synthetic::Camera(), kConfig);
  EXPECT_FALSE(view.has_surroundings);
  EXPECT_EQ(view.roi, cv::Rect(0, 0, 340, 340));
  // The camera looks at the middle of the region.
  const cv::Point2d middle = view.camera.Project({0, 0, 0});
  EXPECT_EQ(middle, cv::Point2d(170, 170));
}

TEST(View, OtherSizesAreScaled) {
  EXPECT_EQ(MakeView(Blank(1280, 960), synthetic::Camera(), kConfig).frame.color.size(),
            cv::Size(640, 480));
  EXPECT_EQ(MakeView(Blank(281, 280), synthetic::Camera(), kConfig).frame.color.size(),
            cv::Size(340, 340));
  EXPECT_EQ(MakeView(Blank(1920, 1080), synthetic::Camera(), kConfig).frame.depth_mm.size(),
            cv::Size(340, 340));
}

TEST(View, TheCameraIsScaledAlong) {
  CameraModel large = OverheadCamera({1230, 1230, 640.5, 480.5, 1280, 960}, 1.066);
  const View view = MakeView(Blank(1280, 960), large, kConfig);
  EXPECT_NEAR(view.camera.pinhole.fx, 615, 1e-12);
  EXPECT_NEAR(view.camera.pinhole.cx, 320, 1e-12);
  EXPECT_NEAR(view.camera.pinhole.cy, 240, 1e-12);
}

TEST(View, DepthsAreNotMixedByScaling) {
  RgbdFrame frame = Blank(1000, 1000);
  frame.depth_mm = 1066;
  frame.depth_mm(cv::Rect(0, 0, 501, 1000)) = 1031;
  const cv::Mat depth = MakeView(frame, synthetic::Camera(), kConfig).frame.depth_mm;
  EXPECT_EQ(cv::countNonZero(depth == 1066) + cv::countNonZero(depth == 1031), 340 * 340);
}

TEST(View, WrongFramesAreRefused) {
  const auto make = [](const RgbdFrame& frame) {
    return MakeView(frame, synthetic::Camera(), kConfig);
  };
  EXPECT_THROW(make({}), std::invalid_argument);
  EXPECT_THROW(make({cv::Mat::zeros(480, 640, CV_8UC1), {}}), InputError);
  EXPECT_THROW(make({cv::Mat::zeros(480, 640, CV_32FC3), {}}), InputError);
  EXPECT_THROW(make({cv::Mat::zeros(480, 640, CV_8UC3), cv::Mat::zeros(480, 640, CV_32FC1)}),
               InputError);
  EXPECT_THROW(make({cv::Mat::zeros(480, 640, CV_8UC3), cv::Mat::zeros(240, 320, CV_16UC1)}),
               InputError);
  EXPECT_NO_THROW(make({cv::Mat::zeros(480, 640, CV_8UC3), {}}));
}

TEST(View, AnImpossibleCameraIsRefused) {
  CameraModel camera = synthetic::Camera();
  camera.pinhole.fx = 0;
  EXPECT_THROW(MakeView(Blank(640, 480), camera, kConfig), InputError);
  camera = synthetic::Camera();
  camera.X_WC.translation().z() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(MakeView(Blank(640, 480), camera, kConfig), InputError);
}

TEST(View, ARegionBeyondTheFrameIsRefused) {
  PerceptionConfig config;
  config.roi_x = 400;
  EXPECT_THROW(MakeView(Blank(640, 480), synthetic::Camera(), config), InputError);
}

}  // namespace
}  // namespace gusset
