#include "perception/labels.h"

#include <gtest/gtest.h>

namespace gusset {
namespace {

const PerceptionConfig kConfig;

struct Masks {
  cv::Mat label = cv::Mat::zeros(340, 340, CV_8UC1);
  cv::Mat bag = cv::Mat::zeros(340, 340, CV_8UC1);
  Masks() { bag(cv::Rect(50, 50, 200, 200)) = 255; }
};

TEST(FindLabels, GivesCentroidsFromTheLargest) {
  Masks masks;
  masks.label(cv::Rect(60, 60, 5, 7)) = 255;
  masks.label(cv::Rect(100, 60, 8, 7)) = 255;
  const std::vector<Label> labels = FindLabels(masks.label, masks.bag, 10, kConfig);
  ASSERT_EQ(labels.size(), 2u);
  EXPECT_EQ(labels[0].centroid, cv::Point2d(103.5, 63));
  EXPECT_EQ(labels[0].area_px2, 56);
  EXPECT_EQ(labels[1].centroid, cv::Point2d(62, 63));
}

TEST(FindLabels, NoiseAndGreenBesideTheBagAreNone) {
  Masks masks;
  masks.label(cv::Rect(60, 60, 3, 3)) = 255;   // Below 10 px^2.
  masks.label(cv::Rect(300, 60, 9, 9)) = 255;  // Not on the bag.
  EXPECT_TRUE(FindLabels(masks.label, masks.bag, 10, kConfig).empty());
}

TEST(FindLabels, AGlintDoesNotMakeTwoOfOne) {
  Masks masks;
  masks.label(cv::Rect(60, 60, 9, 8)) = 255;
  masks.label(cv::Rect(64, 60, 2, 8)) = 0;
  EXPECT_EQ(FindLabels(masks.label, masks.bag, 10, kConfig).size(), 1u);
}

TEST(FindLabels, KeepsNoMoreThanTheBagHas) {
  Masks masks;
  for (int k = 0; k < 8; ++k) masks.label(cv::Rect(60 + 20 * k, 60, 4 + k, 4)) = 255;
  const std::vector<Label> labels = FindLabels(masks.label, masks.bag, 6, kConfig);
  ASSERT_EQ(labels.size(), 6u);
  EXPECT_EQ(labels.back().area_px2, 24);
}

}  // namespace
}  // namespace gusset
