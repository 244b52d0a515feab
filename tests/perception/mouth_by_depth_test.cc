#include "perception/mouth_by_depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/random.h"
#include "perception/opening_area.h"

namespace gusset {
namespace {

const PerceptionConfig kConfig;
constexpr int kMost = 40;

/// A region of interest with a bag of 150 x 180 px on it: cloth of brightness 200 on canvas of 30.
struct Scene {
  cv::Mat grey = cv::Mat(340, 340, CV_32FC1, cv::Scalar(30));
  cv::Mat height_mm = cv::Mat::zeros(340, 340, CV_32FC1);
  cv::Mat bag = cv::Mat::zeros(340, 340, CV_8UC1);

  Scene() {
    const cv::Rect body(90, 80, 150, 180);
    grey(body) = 200;
    bag(body) = 255;
    height_mm(body) = 3;
  }
  /// Stitching along row `y`: 7 % darker, as wide as a thread of 1.2 mm makes it.
  void Stitch(int y, int left = 90, int right = 240) {
    grey(cv::Rect(left, y, right - left, 1)) *= 0.93;
  }
  /// With the noise of the sensor model: 1.5 levels, and depth 1.6 mm at each pixel.
  cv::Mat Color(std::uint64_t seed) const {
    Rng rng(seed);
    cv::Mat soft, color(grey.size(), CV_8UC3);
    cv::GaussianBlur(grey, soft, {}, 0.55);
    for (int y = 0; y < soft.rows; ++y) {
      for (int x = 0; x < soft.cols; ++x) {
        for (int c = 0; c < 3; ++c) {
          color.at<cv::Vec3b>(y, x)[c] =
              cv::saturate_cast<uchar>(soft.at<float>(y, x) + 1.5 * rng.Normal());
        }
      }
    }
    return color;
  }
  cv::Mat Depth(std::uint64_t seed) const {
    Rng rng(seed + 1);
    cv::Mat depth(grey.size(), CV_16UC1);
    for (int y = 0; y < depth.rows; ++y) {
      for (int x = 0; x < depth.cols; ++x) {
        depth.at<std::uint16_t>(y, x) =
            cv::saturate_cast<std::uint16_t>(1066 - height_mm.at<float>(y, x) + 1.6 * rng.Normal());
      }
    }
    return depth;
  }
  std::vector<cv::Point2d> Look(std::uint64_t seed = 1) const {
    return FindLipPoints(Color(seed), Depth(seed), bag, kMost, kConfig);
  }
};

// The mouth is closed: one row of stitching 7 px inside the bag's upper edge, which lies between
// rows 79 and 80. Points are label_inset_px = 4 inside it.
TEST(MouthByDepth, TheHemOfAClosedMouthIsOneLip) {
  Scene scene;
  scene.Stitch(87);
  const auto points = scene.Look();
  ASSERT_GE(points.size(), 5u);
  double left = 340, right = 0;
  for (const cv::Point2d& p : points) {
    EXPECT_NEAR(p.y, 79.5 + kConfig.label_inset_px, 1);  // A ridge is found to a pixel.
    left = std::min(left, p.x);
    right = std::max(right, p.x);
  }
  // All along: the outermost points are half a spacing from the ends, and profiles of 15 px lose
  // some of those.
  EXPECT_LT(left, 90 + kConfig.hem_spacing_px);
  EXPECT_GT(right, 240 - kConfig.hem_spacing_px);
  // Shut: a strip as thin as the points are uncertain.
  EXPECT_LT(MeasureOpening(points).area_px2, 150 * 1.5);
}

// The upper layer ends at row 140, 10 mm above the lower one: a mouth between lips 60 px apart.
TEST(MouthByDepth, AnOpenMouthHasTheAreaBetweenItsLips) {
  Scene scene;
  scene.Stitch(87);
  scene.height_mm(cv::Rect(90, 140, 150, 120)) = 13;
  scene.Stitch(147);
  const auto points = scene.Look();
  double top = 340, bottom = 0, left = 340, right = 0;
  for (const cv::Point2d& p : points) {
    top = std::min(top, p.y);
    bottom = std::max(bottom, p.y);
    left = std::min(left, p.x);
    right = std::max(right, p.x);
  }
  EXPECT_NEAR(bottom - top, 60, 3);  // Depth steps are found to a pixel or two.
  // Algorithm 7 fills what lies between two rows of points, but for wedges at its sides.
  const double area = MeasureOpening(points).area_px2;
  EXPECT_LE(area, (bottom - top) * (right - left));
  EXPECT_GE(area, 0.5 * (bottom - top) * (right - left));
}

// The same stitching without an edge, and the same step without stitching.
TEST(MouthByDepth, NeitherALineNorAStepAloneIsALip) {
  Scene line;
  line.Stitch(170);
  EXPECT_TRUE(line.Look().empty());
  Scene step;
  step.height_mm(cv::Rect(90, 140, 150, 120)) = 13;
  EXPECT_TRUE(step.Look().empty());
}

TEST(MouthByDepth, NoiseAloneHasNoMouth) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    EXPECT_TRUE(Scene().Look(seed).empty()) << seed;
  }
}

// Without depth the lip on the bag's edge is still found, the one on the bag is not.
TEST(MouthByDepth, WithoutDepthOnlyTheBagsOwnEdgeIsALip) {
  Scene scene;
  scene.Stitch(87);
  scene.height_mm(cv::Rect(90, 140, 150, 120)) = 13;
  scene.Stitch(147);
  const auto points = FindLipPoints(scene.Color(1), {}, scene.bag, kMost, kConfig);
  ASSERT_GE(points.size(), 5u);
  for (const cv::Point2d& p : points) EXPECT_LT(p.y, 90);
}

// Pixels turn exactly; what differs is which of two equal neighbours is a crest.
TEST(MouthByDepth, QuarterTurnsTurnTheLips) {
  Scene scene;
  scene.Stitch(87);
  cv::Mat color = scene.Color(3), depth = scene.Depth(3), bag = scene.bag;
  const auto upright = FindLipPoints(color, depth, bag, kMost, kConfig);
  cv::Point2d mean(0, 0);
  for (const cv::Point2d& p : upright) mean += p / static_cast<double>(upright.size());
  for (int turn = 0; turn < 3; ++turn) {
    for (cv::Mat* image : {&color, &depth, &bag}) {
      cv::Mat turned;
      cv::rotate(*image, turned, cv::ROTATE_90_CLOCKWISE);
      *image = turned;
    }
    mean = {339 - mean.y, mean.x};
    const auto points = FindLipPoints(color, depth, bag, kMost, kConfig);
    ASSERT_EQ(points.size(), upright.size());
    cv::Point2d turned_mean(0, 0);
    for (const cv::Point2d& p : points) turned_mean += p / static_cast<double>(points.size());
    EXPECT_LT(cv::norm(turned_mean - mean), 1) << turn;
  }
}

TEST(MouthByDepth, GivesAtMostAsManyPointsAsAskedFor) {
  Scene scene;
  scene.Stitch(87);
  EXPECT_EQ(FindLipPoints(scene.Color(1), scene.Depth(1), scene.bag, 2, kConfig).size(), 2u);
  EXPECT_TRUE(FindLipPoints(scene.Color(1), scene.Depth(1), scene.bag, 0, kConfig).empty());
}

TEST(MouthByDepth, RefusesImagesThatDoNotBelongTogether) {
  const Scene scene;
  const cv::Mat color = scene.Color(1), depth = scene.Depth(1);
  EXPECT_THROW((void)FindHem(cv::Mat(), depth, scene.bag, kConfig), InputError);
  EXPECT_THROW((void)FindHem(scene.bag, depth, scene.bag, kConfig), InputError);
  EXPECT_THROW((void)FindHem(color, color, scene.bag, kConfig), InputError);
  EXPECT_THROW((void)FindHem(color, depth, cv::Mat(), kConfig), InputError);
  EXPECT_THROW((void)FindHem(color, depth(cv::Rect(0, 0, 9, 9)), scene.bag, kConfig), InputError);
}

}  // namespace
}  // namespace gusset
