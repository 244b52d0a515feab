#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "base/config.h"
#include "base/error.h"
#include "sim/render/scene_view.h"
#include "sim/render/sensor.h"

namespace gusset {
namespace {

RgbdFrame Plain() {
  return {cv::Mat(480, 640, CV_8UC3, cv::Scalar(120, 130, 140)),
          cv::Mat(480, 640, CV_16UC1, cv::Scalar(1066))};
}

TEST(Sensor, SameSeedSameNoise) {
  RgbdFrame a = Plain(), b = Plain(), c = Plain();
  Rng rng_a(5), rng_b(5), rng_c(6);
  AddSensorNoise(a, {}, rng_a);
  AddSensorNoise(b, {}, rng_b);
  AddSensorNoise(c, {}, rng_c);
  EXPECT_EQ(cv::norm(a.color, b.color), 0);
  EXPECT_EQ(cv::norm(a.depth_mm, b.depth_mm), 0);
  EXPECT_GT(cv::norm(a.color, c.color), 0);
  EXPECT_GT(cv::norm(a.depth_mm, c.depth_mm), 0);
}

TEST(Sensor, DepthNoiseHasTheGivenDeviation) {
  const SensorConfig config{.depth_sigma_mm = 1.5};
  cv::Scalar mean, deviation;
  RgbdFrame frame = Plain();
  Rng rng(1);
  AddSensorNoise(frame, config, rng);
  cv::meanStdDev(frame.depth_mm, mean, deviation);
  // The smooth part has 4,800 independent cells of 1.9 mm: 1.9 / sqrt(4800) = 0.027 mm, 3 sigma.
  EXPECT_NEAR(mean[0], 1066, 0.08);
  // Rounding to whole millimetres adds a variance of 1/12.
  EXPECT_NEAR(deviation[0], std::sqrt(1.5 * 1.5 + 1.0 / 12), 0.05);
}

TEST(Sensor, DepthNoiseIsSmoothOverNeighboursAndFreshFarther) {
  const SensorConfig config{.depth_sigma_mm = 3, .depth_correlated = 0.7};
  RgbdFrame frame = Plain();
  Rng rng(2);
  AddSensorNoise(frame, config, rng);
  cv::Mat noise;
  frame.depth_mm.convertTo(noise, CV_64F, 1, -1066);
  const auto correlation = [&](int lag) {
    const cv::Mat a = noise.colRange(0, 600), b = noise.colRange(lag, 600 + lag);
    return a.dot(b) / std::sqrt(a.dot(a) * b.dot(b));
  };
  EXPECT_NEAR(correlation(1), 0.7, 0.06);
  EXPECT_NEAR(correlation(24), 0, 0.06);
}

TEST(Sensor, ColourNoiseHasTheGivenDeviation) {
  RgbdFrame frame = Plain();
  Rng rng(3);
  AddSensorNoise(frame, {.color_sigma = 1.5}, rng);
  cv::Scalar mean, deviation;
  cv::meanStdDev(frame.color, mean, deviation);
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_NEAR(mean[channel], 120 + 10 * channel, 0.02);
    EXPECT_NEAR(deviation[channel], std::sqrt(1.5 * 1.5 + 1.0 / 12), 0.03);
  }
}

TEST(Sensor, PixelsWithoutDepthStayWithout) {
  RgbdFrame frame = Plain();
  frame.depth_mm.colRange(0, 100) = 0;
  frame.depth_mm.colRange(100, 200) = 1;
  Rng rng(4);
  AddSensorNoise(frame, {.depth_sigma_mm = 20}, rng);
  EXPECT_EQ(cv::countNonZero(frame.depth_mm.colRange(0, 100)), 0);
  EXPECT_EQ(cv::countNonZero(frame.depth_mm.colRange(100, 640)), 540 * 480);
}

TEST(Sensor, ZeroEverywhereChangesNothing) {
  RgbdFrame frame = Plain();
  Rng rng(5);
  AddSensorNoise(frame, {.depth_sigma_mm = 0, .color_sigma = 0, .blur_px = 0}, rng);
  EXPECT_EQ(cv::norm(frame.color, Plain().color), 0);
  EXPECT_EQ(cv::norm(frame.depth_mm, Plain().depth_mm), 0);
}

TEST(Sensor, DefaultsLieWithinTheirBounds) {
  EXPECT_NO_THROW(ValidateOrThrow("sensor", SensorConfig{}));
  EXPECT_NO_THROW(ValidateOrThrow("light", LightConfig{}));
  EXPECT_THROW(ValidateOrThrow("sensor", SensorConfig{.depth_correlated = 1.5}), InputError);
}

TEST(Sensor, GainScalesBrightnessAndDepthMayBeMissing) {
  RgbdFrame frame = Plain();
  frame.depth_mm.release();
  Rng rng(6);
  AddSensorNoise(frame, {.color_sigma = 0, .gain = 0.5}, rng);
  EXPECT_EQ(frame.color.at<cv::Vec3b>(100, 100), cv::Vec3b(60, 65, 70));
  EXPECT_TRUE(frame.depth_mm.empty());
}

}  // namespace
}  // namespace gusset
