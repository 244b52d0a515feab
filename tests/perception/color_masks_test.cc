#include "perception/color_masks.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "base/random.h"
#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

const PerceptionConfig kConfig;

ColorMasks MasksOf(const RgbdFrame& frame) {
  return ThresholdColors(MakeView(frame, synthetic::Camera(), kConfig), kConfig);
}

// Pixels of the region of interest at which cloth and label are mixed.
constexpr int kMixedRow = 170;
RgbdFrame MixedFrame(double gain) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame);
  for (int tenth = 0; tenth <= 10; ++tenth) {
    const double share = 0.1 * tenth;
    frame.color.at<cv::Vec3b>(kMixedRow + kConfig.roi_y, 140 + 5 * tenth + kConfig.roi_x) =
        cv::Vec3d(synthetic::kCloth[0], synthetic::kCloth[1], synthetic::kCloth[2]) * (1 - share) +
        cv::Vec3d(synthetic::kLabel[0], synthetic::kLabel[1], synthetic::kLabel[2]) * share;
  }
  synthetic::Light(frame, gain, 0, 1);
  return frame;
}

// Saturation is 1 - min/max: linear in the mixture but for what the greatest channel changes, from
// 209 to 196, and that the greatest one is red for cloth and green for a label: 0.03 each. Eight
// bits of a weaker light add 0.01.
TEST(ColorMasks, CoverIsTheShareOfALabelInAPixelWhateverTheLight) {
  for (const double gain : {1.0, 0.7}) {
    const ColorMasks masks = MasksOf(MixedFrame(gain));
    for (int tenth = 0; tenth <= 10; ++tenth) {
      EXPECT_NEAR(masks.label_cover.at<uchar>(kMixedRow, 140 + 5 * tenth) / 255., 0.1 * tenth, 0.07)
          << gain;
    }
  }
}

// Blue light on cream cloth made the cloth as saturated as a pixel that is a third label, and of
// another hue: labels lost their edges (a quarter of their area in rendered frames). What tint of
// light leaves is that mixing is linear and a tint is not quite taken off in eight bits.
TEST(ColorMasks, CoverIsTheShareOfALabelInAPixelWhateverTheTint) {
  for (const cv::Scalar& tint : {cv::Scalar(1.0, 0.8, 0.75), cv::Scalar(0.9, 0.8, 0.9),
                                 cv::Scalar(0.75, 0.85, 1.0), cv::Scalar(0.85, 1.0, 0.85)}) {
    RgbdFrame frame = MixedFrame(1);
    cv::multiply(frame.color, tint, frame.color);
    const ColorMasks masks = MasksOf(frame);
    for (int tenth = 0; tenth <= 10; ++tenth) {
      EXPECT_NEAR(masks.label_cover.at<uchar>(kMixedRow, 140 + 5 * tenth) / 255., 0.1 * tenth, 0.08)
          << tint;
    }
  }
}

// Vectors of sixteen end before the region does.
TEST(ColorMasks, TintIsTakenOffToTheLastColumn) {
  RgbdFrame frame = synthetic::EmptyTable();
  const cv::Rect roi(kConfig.roi_x, kConfig.roi_y, kConfig.roi_side, kConfig.roi_side);
  frame.color(roi) = synthetic::kCloth;
  frame.color(roi)(cv::Rect(100, 100, 12, 12)) = synthetic::kLabel;
  frame.color(roi)(cv::Rect(331, 200, 9, 12)) = synthetic::kLabel;
  cv::multiply(frame.color, cv::Scalar(0.75, 0.85, 1.0), frame.color);
  const ColorMasks masks = MasksOf(frame);
  for (int x = 320; x < 340; ++x) {
    EXPECT_EQ(masks.label_cover.at<uchar>(50, x), masks.label_cover.at<uchar>(50, 150)) << x;
    const cv::Point as_label(x < 331 ? 150 : 105, 105);
    EXPECT_EQ(masks.label_cover.at<uchar>(205, x), masks.label_cover.at<uchar>(as_label)) << x;
  }
}

// A toy, a cable: twice as saturated as labels, and larger than all of them.
TEST(ColorMasks, GreenThingsOnTheCanvasDoNotChangeWhatALabelCovers) {
  RgbdFrame frame = MixedFrame(1);
  const cv::Point roi(kConfig.roi_x, kConfig.roi_y);
  // A scrap of paper in a corner, so that the toy lies between things of cloth's colour.
  frame.color(cv::Rect(2, 2, 4, 4) + roi) = synthetic::kCloth;
  const cv::Mat alone = MasksOf(frame).label_cover.clone();
  const cv::Rect toy(20, 20, 40, 30);
  frame.color(toy + roi) = cv::Scalar(10, 180, 90);
  const ColorMasks masks = MasksOf(frame);
  ASSERT_EQ(cv::countNonZero(masks.label(toy)), toy.area()) << "of a label's colour";
  cv::Mat elsewhere = cv::Mat::ones(alone.size(), CV_8UC1);
  elsewhere(toy) = 0;
  EXPECT_EQ(cv::norm(alone, masks.label_cover, cv::NORM_INF, elsewhere), 0);
}

// Labels are sought on what has cloth's colour, and a label's length round it.
TEST(ColorMasks, GreenThingsFarFromTheClothAreNoLabels) {
  RgbdFrame frame = MixedFrame(1);
  const ColorMasks before = MasksOf(frame);
  const cv::Rect box = cv::boundingRect(before.cloth);
  ASSERT_GT(box.x, 40);
  for (const int apart : {5, 30}) {
    RgbdFrame with = frame;
    with.color = frame.color.clone();
    const cv::Rect toy(box.x - apart - 4, box.y + 20, 4, 30);
    with.color(toy + cv::Point(kConfig.roi_x, kConfig.roi_y)) = cv::Scalar(10, 180, 90);
    EXPECT_EQ(cv::countNonZero(MasksOf(with).label(toy)), apart == 5 ? toy.area() : 0);
  }
}

// What is grey is not converted, so ask cv::inRange, which looks everywhere.
TEST(ColorMasks, CubeIsWhereItsColourIsInTheWholeFrame) {
  Rng rng(7);
  for (int k = 0; k < 40; ++k) {
    RgbdFrame frame = synthetic::EmptyTable();
    synthetic::DrawFlatBag(frame);
    synthetic::DrawCube(frame, {rng.Below(600) + 20., rng.Below(440) + 20.});
    // Bright and dull reds and other specks, down to single pixels, at the image's edge too.
    for (int speck = 0; speck < 60; ++speck) {
      const cv::Point at(rng.Below(640), rng.Below(480));
      frame.color.at<cv::Vec3b>(at) =
          cv::Vec3b(static_cast<uchar>(rng.Below(120)), static_cast<uchar>(rng.Below(120)),
                    static_cast<uchar>(rng.Below(256)));
    }
    cv::Mat hsv, high, low;
    cv::cvtColor(frame.color, hsv, cv::COLOR_BGR2HSV);
    const auto &min = kConfig.cube_hsv_min, &max = kConfig.cube_hsv_max;
    ASSERT_GT(min[0], max[0]) << "red wraps";
    cv::inRange(hsv, cv::Scalar(min[0], min[1], min[2]), cv::Scalar(255, max[1], max[2]), high);
    cv::inRange(hsv, cv::Scalar(0, min[1], min[2]), cv::Scalar(max[0], max[1], max[2]), low);
    EXPECT_EQ(cv::norm(MasksOf(frame).cube, high | low, cv::NORM_INF), 0);
  }
}

TEST(ColorMasks, NothingCoversClothCubeAndCanvas) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame, {}, 0);
  synthetic::DrawCube(frame, {320, 240});
  EXPECT_EQ(cv::countNonZero(MasksOf(frame).label_cover > 10), 0);
}

}  // namespace
}  // namespace gusset
