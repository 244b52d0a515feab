#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <opencv2/core.hpp>

#include "base/config.h"
#include "base/error.h"
#include "sim/render/depth_sensor.h"
#include "sim/render/scene_view.h"
#include "sim/render/sensor.h"

namespace gusset {
namespace {

constexpr double kFx_px = 615;

RgbdFrame Plain(double depth_mm = 1066) {
  return {cv::Mat(480, 640, CV_8UC3, cv::Scalar(120, 130, 140)),
          cv::Mat(480, 640, CV_16UC1, cv::Scalar(depth_mm))};
}

/// No part of the model; tests switch on what they are about.
SensorConfig Nothing() {
  SensorConfig config;
  config.depth_sigma_mm = config.disparity_step_px = config.edge_step_mm = 0;
  config.shadows = false;
  config.color_sigma = config.blur_px = 0;
  return config;
}

RgbdFrame Seen(RgbdFrame frame, const SensorConfig& config, std::uint64_t seed = 1) {
  Rng rng(seed);
  AddSensorNoise(frame, config, kFx_px, rng);
  return frame;
}

bool Same(const RgbdFrame& a, const RgbdFrame& b) {
  return cv::norm(a.color, b.color, cv::NORM_INF) == 0 &&
         cv::norm(a.depth_mm, b.depth_mm, cv::NORM_INF) == 0;
}

/// A plane at 1066 mm and on it a box, rows 100..199, columns 200..299, that stands height_mm out.
RgbdFrame BoxOnPlane(int height_mm) {
  RgbdFrame frame = Plain();
  frame.depth_mm(cv::Rect(200, 100, 100, 100)) = 1066 - height_mm;
  return frame;
}

struct Spread {
  double mean, deviation;
};
Spread SpreadOf(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return {mean[0], deviation[0]};
}

TEST(Sensor, SameSeedSameBitsOtherSeedOthers) {
  const RgbdFrame a = Seen(BoxOnPlane(50), {}, 5);
  EXPECT_TRUE(Same(a, Seen(BoxOnPlane(50), {}, 5)));
  const RgbdFrame c = Seen(BoxOnPlane(50), {}, 6);
  EXPECT_GT(cv::norm(a.color, c.color), 0);
  EXPECT_GT(cv::norm(a.depth_mm, c.depth_mm), 0);
}

TEST(Sensor, PresetCleanIsTheIdealFrameWhateverElseIsSet) {
  SensorConfig config;
  config.preset = "clean";
  config.depth_sigma_mm = 20;
  config.gain = 0.5;
  EXPECT_TRUE(Same(Seen(BoxOnPlane(50), config), BoxOnPlane(50)));
}

TEST(Sensor, APresetDoesNotMoveLaterDraws) {
  Rng a(3), b(3);
  RgbdFrame frame = Plain(), other = Plain();
  AddSensorNoise(frame, {.preset = "clean"}, kFx_px, a);
  AddSensorNoise(other, {}, kFx_px, b);
  EXPECT_EQ(a.Bits(), b.Bits());
}

TEST(Sensor, AllPartsOffChangesNothing) {
  EXPECT_TRUE(Same(Seen(BoxOnPlane(50), Nothing()), BoxOnPlane(50)));
}

class DepthNoiseAt : public testing::TestWithParam<int> {};

// Whitepaper's formula: the deviation is z^2 / (f B) times the disparity's, so z^2 times what it is
// at 1 m. The smooth part has 4,800 independent cells, so a deviation is known to 1 %; bounds 4 %.
TEST_P(DepthNoiseAt, GrowsWithTheSquareOfTheDistance) {
  SensorConfig config = Nothing();
  config.depth_sigma_mm = 3;
  const double z_m = GetParam() / 1000.0;
  const Spread noise = SpreadOf(Seen(Plain(GetParam()), config).depth_mm);
  const double sigma = 3 * z_m * z_m;
  // Rounding to whole millimetres adds a variance of 1/12.
  const double expected = std::sqrt(sigma * sigma + 1.0 / 12);
  EXPECT_GT(noise.deviation, 0.96 * expected);
  EXPECT_LT(noise.deviation, 1.04 * expected);
  // Three deviations of the smooth part's mean, and the bias sigma^2 / z of an inverse.
  EXPECT_NEAR(noise.mean, GetParam() + sigma * sigma / GetParam(), 0.08 * sigma);
}
INSTANTIATE_TEST_SUITE_P(Distances, DepthNoiseAt, testing::Values(500, 707, 1066, 2000, 4000));

TEST(Sensor, DisparityStepsAreAsWideAsTheFormulaSays) {
  SensorConfig config = Nothing();
  config.disparity_step_px = 1.0 / 32;
  // A ramp from 2 m to 2.64 m in steps of 1 mm.
  RgbdFrame frame = Plain();
  for (int u = 0; u < 640; ++u) frame.depth_mm.col(u) = 2000 + u;
  const cv::Mat row = Seen(frame, config).depth_mm.row(240);
  const double fb = 638 * 50;
  int steps = 0;
  for (int u = 1; u < 640; ++u) {
    const int z = row.at<std::uint16_t>(u);
    EXPECT_LE(std::abs(z - (2000 + u)), 0.5 + 0.5 * z * z / fb / 32 + 0.5);
    const double d = fb / z * 32;  // in steps: whole, but for the rounding of z to 0.5 mm
    EXPECT_NEAR(d, std::round(d), 0.5 * d / z + 1e-3);
    steps += z != row.at<std::uint16_t>(u - 1);
  }
  // From d = 15.95 px to 12.09 px there are 32 times as many steps as pixels of disparity.
  EXPECT_NEAR(steps, 32 * (fb / 2000 - fb / 2639), 2);
}

TEST(Sensor, DepthNoiseIsSmoothOverNeighboursAndFreshFarther) {
  SensorConfig config = Nothing();
  config.depth_sigma_mm = 3;
  cv::Mat noise;
  Seen(Plain(), config, 2).depth_mm.convertTo(noise, CV_64F, 1, -1066);
  const auto correlation = [&](int lag) {
    const cv::Mat a = noise.colRange(0, 600), b = noise.colRange(lag, 600 + lag);
    return a.dot(b) / std::sqrt(a.dot(a) * b.dot(b));
  };
  EXPECT_NEAR(correlation(1), 0.7, 0.06);
  EXPECT_NEAR(correlation(24), 0, 0.06);
}

class ShadowOfABox : public testing::TestWithParam<int> {};

// The imagers look from the right, so the box hides a strip on its left whose width in the colour
// image is w = fx b (1/z_near - 1/z_far). Pixels at 1, 2, ... from the box's first column are
// hidden while nearer to it than w.
TEST_P(ShadowOfABox, IsAsWideAsTheRayFromTheFartherImagerSays) {
  SensorConfig config = Nothing();
  config.shadows = true;
  const int height_mm = GetParam();
  const double w = kFx_px * (0.015 + 0.050) * (1000.0 / (1066 - height_mm) - 1000.0 / 1066);
  const int hidden = static_cast<int>(std::ceil(w)) - 1;
  const cv::Mat depth = Seen(BoxOnPlane(height_mm), config).depth_mm;
  for (int row = 0; row < 480; ++row) {
    const bool beside = row >= 100 && row < 200;
    for (int u = 0; u < 640; ++u) {
      const bool expected = beside && u < 200 && u >= 200 - hidden;
      ASSERT_EQ(depth.at<std::uint16_t>(row, u) == 0, expected) << "row " << row << ", u " << u;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(Heights, ShadowOfABox, testing::Values(1, 35, 100, 300, 600));

// The formula's other route: a ray from the imager to the point on the plane is blocked by the box
// if it passes through the box's left upper edge's side.
TEST(Sensor, ShadowIsWhatARayFromTheImagerCannotReach) {
  SensorConfig config = Nothing();
  config.shadows = true;
  const double z_far = 1.066, z_near = 0.766, imager_x = 0.065;
  const cv::Mat depth = Seen(BoxOnPlane(300), config).depth_mm;
  // First column of the box, as it is in the colour image, at the box's upper face.
  const double edge_x = (200 - 320.0) / kFx_px * z_near;
  for (int u = 100; u < 200; ++u) {
    const double x = (u - 320.0) / kFx_px * z_far;
    const double at_upper_face = imager_x + (x - imager_x) * z_near / z_far;
    EXPECT_EQ(depth.at<std::uint16_t>(150, u) == 0, at_upper_face > edge_x) << u;
  }
}

TEST(Sensor, EdgesHaveNoDepthAndGentleSlopesDo) {
  SensorConfig config = Nothing();
  config.edge_step_mm = 15;
  // Within a pixel of the box's border, on either side; rows and columns 199..300.
  const int ring = 102 * 102 - 98 * 98;
  EXPECT_EQ(cv::countNonZero(Seen(BoxOnPlane(35), config).depth_mm == 0), ring);
  EXPECT_EQ(cv::countNonZero(Seen(BoxOnPlane(16), config).depth_mm == 0), ring);
  EXPECT_EQ(cv::countNonZero(Seen(BoxOnPlane(15), config).depth_mm == 0), 0);
  // A slope of 7 mm per pixel, 76 degrees here, is seen; one of 8 mm is not.
  for (const int slope : {7, 8}) {
    RgbdFrame frame = Plain();
    for (int u = 0; u < 40; ++u) frame.depth_mm.col(u) = 1066 - 7 * 40 + slope * u;
    EXPECT_EQ(Seen(frame, config).depth_mm.at<std::uint16_t>(9, 20) == 0, slope == 8);
  }
}

TEST(Sensor, PixelsWithoutDepthStayWithoutAndOthersStayPositive) {
  RgbdFrame frame = Plain();
  frame.depth_mm.colRange(0, 100) = 0;
  frame.depth_mm.colRange(100, 200) = 1;
  frame.depth_mm.colRange(200, 300) = 65535;
  SensorConfig config = Nothing();
  config.depth_sigma_mm = 20;
  config.disparity_step_px = 1;
  const cv::Mat depth = Seen(frame, config).depth_mm;
  EXPECT_EQ(cv::countNonZero(depth.colRange(0, 100)), 0);
  EXPECT_EQ(cv::countNonZero(depth.colRange(100, 640)), 540 * 480);
}

TEST(Sensor, ColourNoiseHasTheGivenDeviation) {
  SensorConfig config = Nothing();
  config.color_sigma = 1.5;
  cv::Scalar mean, deviation;
  cv::meanStdDev(Seen(Plain(), config, 3).color, mean, deviation);
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(mean[channel], 120 + 10 * channel, 0.02);
    // Rounding to whole levels adds a variance of 1/12.
    EXPECT_NEAR(deviation[channel], std::sqrt(1.5 * 1.5 + 1.0 / 12), 0.03);
  }
}

TEST(Sensor, ExposureAndWhiteBalanceScaleTheirChannelsAndInvert) {
  SensorConfig config = Nothing();
  config.gain = 0.5;
  config.red_gain = 1.25;
  config.blue_gain = 0.8;
  RgbdFrame frame = Seen(Plain(), config);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(100, 100), cv::Vec3b(48, 65, 88));  // 87.5 rounds up
  EXPECT_EQ(cv::norm(frame.depth_mm, Plain().depth_mm), 0);
  config.gain = 1 / config.gain;
  config.red_gain = 1 / config.red_gain;
  config.blue_gain = 1 / config.blue_gain;
  const cv::Vec3b back = Seen(frame, config).color.at<cv::Vec3b>(100, 100);
  // Half a level of rounding, scaled by 2 / 0.8 at most, and half a level more.
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(back[channel], 120 + 10 * channel, 1.75);
}

TEST(Sensor, DepthMayBeMissing) {
  RgbdFrame frame = Plain();
  frame.depth_mm.release();
  EXPECT_TRUE(Seen(frame, {}).depth_mm.empty());
}

TEST(Sensor, DefaultsLieWithinTheirBoundsAndOthersAreRefused) {
  EXPECT_NO_THROW(ValidateOrThrow("sensor", SensorConfig{}));
  EXPECT_NO_THROW(ValidateOrThrow("light", LightConfig{}));
  EXPECT_THROW(ValidateOrThrow("sensor", SensorConfig{.depth_correlated = 1.5}), InputError);
  EXPECT_THROW(ValidateOrThrow("sensor", SensorConfig{.preset = "kinect"}), InputError);
  EXPECT_THROW(ValidateOrThrow("sensor", SensorConfig{.depth_sigma_mm = std::nan("")}), InputError);
}

}  // namespace
}  // namespace gusset
