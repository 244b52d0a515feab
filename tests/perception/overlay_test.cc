#include "perception/overlay.h"

#include <gtest/gtest.h>

#include "perception/perceive.h"
#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

int Count(const cv::Mat& image, const cv::Vec3b& color) {
  int count = 0;
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) count += image.at<cv::Vec3b>(y, x) == color;
  }
  return count;
}

const cv::Vec3b kGreen(0, 255, 0);
const cv::Vec3b kCyan(255, 255, 0);
const cv::Vec3b kRed(0, 0, 255);
const cv::Vec3b kBlue(255, 0, 0);

cv::Mat Draw(const RgbdFrame& frame) {
  return DrawOverlay(frame, Perceive(frame, synthetic::Camera(), {}, {}));
}

RgbdFrame WaitingCube() {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawCube(frame, {566, 240});
  return frame;
}

TEST(Overlay, IsTheRegionOfInterestAndLeavesTheFrameAlone) {
  RgbdFrame frame = WaitingCube();
  synthetic::DrawFlatBag(frame);
  const cv::Mat before = frame.color.clone();
  const cv::Mat overlay = Draw(frame);
  EXPECT_EQ(overlay.size(), cv::Size(340, 340));
  EXPECT_EQ(overlay.type(), CV_8UC3);
  EXPECT_EQ(cv::norm(frame.color, before, cv::NORM_INF), 0);
}

TEST(Overlay, FoldedHasCyanGridAndRedPoints) {
  RgbdFrame frame = WaitingCube();
  synthetic::DrawFoldedBag(frame);
  const cv::Mat overlay = Draw(frame);
  EXPECT_GT(Count(overlay, kGreen), 300);
  EXPECT_GT(Count(overlay, kCyan), 100);
  EXPECT_GT(Count(overlay, kRed), 9 * 30);
  EXPECT_EQ(Count(overlay, kBlue), 0);
}

TEST(Overlay, UnfoldedHasRedRimPointsAndBlueTargets) {
  RgbdFrame frame = WaitingCube();
  synthetic::DrawFlatBag(frame);
  const cv::Mat overlay = Draw(frame);
  EXPECT_GT(Count(overlay, kRed), 9 * 4);
  EXPECT_GT(Count(overlay, kBlue), 9 * 4);
}

TEST(Overlay, WithoutBagThereIsOnlyText) {
  const cv::Mat overlay = Draw(WaitingCube());
  EXPECT_EQ(Count(overlay, kGreen), 0);
  EXPECT_EQ(Count(overlay, kRed), 0);
  const cv::Rect text(0, 260, 160, 80);
  EXPECT_GT(cv::norm(overlay(text), WaitingCube().color(text + cv::Point(150, 70)), cv::NORM_INF),
            150);
}

TEST(Overlay, OfABareRegionOfAnotherSizeIsTheSameSize) {
  RgbdFrame frame{cv::Mat(281, 281, CV_8UC3, synthetic::kCanvas), {}};
  EXPECT_EQ(Draw(frame).size(), cv::Size(340, 340));
}

}  // namespace
}  // namespace gusset
