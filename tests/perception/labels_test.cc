#include "perception/labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

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
  masks.label(cv::Rect(60, 60, 2, 4)) = 255;   // Below 10 px^2, what its edge lost included.
  masks.label(cv::Rect(300, 60, 9, 9)) = 255;  // Not on the bag.
  EXPECT_TRUE(FindLabels(masks.label, masks.bag, 10, kConfig).empty());
}

TEST(FindLabels, AGlintDoesNotMakeTwoOfOne) {
  Masks masks;
  masks.label(cv::Rect(60, 60, 9, 8)) = 255;
  masks.label(cv::Rect(64, 60, 2, 8)) = 0;
  EXPECT_EQ(FindLabels(masks.label, masks.bag, 10, kConfig).size(), 1u);
  // A column that is not quite of either part lies beside both, and counts once.
  masks.label(cv::Rect(64, 60, 2, 8)) = 255;
  masks.label(cv::Rect(64, 60, 1, 8)) = 60;
  const std::vector<Label> labels = FindLabels(masks.label, masks.bag, 10, kConfig);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_NEAR(labels[0].area_px2, 64 + 8 * 60 / 255., 0.01);
}

// Three columns and eight rows that a label covers by half are twelve pixels of label; by 0.4, 9.6
// are left of the ten that count, by 0.35 8.4, which is less than an edge loses.
TEST(FindLabels, PartsOfPixelsCountAsParts) {
  Masks masks;
  const cv::Rect sliver(60, 60, 3, 8);
  masks.label(sliver) = 128;
  const std::vector<Label> labels = FindLabels(masks.label, masks.bag, 10, kConfig);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_NEAR(labels[0].area_px2, 12, 0.1);
  EXPECT_NEAR(labels[0].centroid.x, 61, 1e-9);
  EXPECT_NEAR(labels[0].centroid.y, 63.5, 1e-9);
  masks.label(sliver) = 102;
  EXPECT_EQ(FindLabels(masks.label, masks.bag, 10, kConfig).size(), 1u);
  masks.label(sliver) = 89;
  EXPECT_TRUE(FindLabels(masks.label, masks.bag, 10, kConfig).empty());
}

// The soft edge beside a spot is part of its label: columns covered by 0.25, 1, 1 and 0.75 are
// three wide, and their middle lies where that of the label is, a quarter to the right.
TEST(FindLabels, TheSoftEdgeCounts) {
  Masks masks;
  masks.label(cv::Rect(59, 60, 1, 8)) = 64;
  masks.label(cv::Rect(60, 60, 2, 8)) = 255;
  masks.label(cv::Rect(62, 60, 1, 8)) = 191;
  const std::vector<Label> labels = FindLabels(masks.label, masks.bag, 10, kConfig);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_NEAR(labels[0].area_px2, 24, 0.05);
  EXPECT_NEAR(labels[0].centroid.x, (0.25 * 59 + 60 + 61 + 0.75 * 62) / 3, 0.01);
}

// What is left of two labels where a bag's corner folds: slivers two pixels apart.
TEST(FindLabels, SliversSideBySideAreTwo) {
  Masks masks;
  masks.label(cv::Rect(60, 60, 3, 7)) = 255;
  masks.label(cv::Rect(65, 64, 3, 6)) = 255;
  EXPECT_EQ(FindLabels(masks.label, masks.bag, 10, kConfig).size(), 2u);
}

// A rectangle of n pixels has the length sqrt(n^2 - 1) by its second moment.
TEST(FindLabels, OneLongerThanALabelIsTwo) {
  for (const auto& [length, count] : {std::pair(8, 1u), {9, 1u}, {10, 2u}, {11, 2u}}) {
    Masks masks;
    masks.label(cv::Rect(60, 60, 7, length)) = 255;
    EXPECT_EQ(FindLabels(masks.label, masks.bag, 10, kConfig).size(), count) << length;
  }
}

TEST(FindLabels, KeepsNoMoreThanTheBagHas) {
  Masks masks;
  for (int k = 0; k < 8; ++k) masks.label(cv::Rect(60 + 20 * k, 60, 2 + k, 5)) = 255;
  const std::vector<Label> labels = FindLabels(masks.label, masks.bag, 6, kConfig);
  ASSERT_EQ(labels.size(), 6u);
  EXPECT_EQ(labels.back().area_px2, 20);
}

// A layer's label of 7 x 8 px and the other layer's beside it, in any direction: two, each at its
// middle to 1.6 px (the cut is straight, across the spot: with the labels shifted by half their
// width it takes a corner of one and leaves one of the other).
TEST(FindLabels, TwoThatTouchAreTwo) {
  for (const double turn_deg : {0.0, 20.0, 45.0, 77.0}) {
    for (const double aside : {0.0, 2.0, 4.0}) {
      Masks masks;
      const double a = turn_deg * CV_PI / 180;
      const cv::Point2d along(std::cos(a), std::sin(a)), across(-along.y, along.x);
      const cv::Point2d first(150, 150), second = first + 7.5 * along + aside * across;
      for (int y = 120; y < 190; ++y) {
        for (int x = 120; x < 190; ++x) {
          for (const cv::Point2d& centre : {first, second}) {
            const cv::Point2d d = cv::Point2d(x, y) - centre;
            if (std::abs(d.dot(along)) <= 4 && std::abs(d.dot(across)) <= 3.5) {
              masks.label.at<uchar>(y, x) = 255;
            }
          }
        }
      }
      std::vector<Label> labels = FindLabels(masks.label, masks.bag, 10, kConfig);
      ASSERT_EQ(labels.size(), 2u) << turn_deg << " " << aside;
      std::ranges::sort(labels, {}, [&](const Label& l) { return l.centroid.dot(along); });
      EXPECT_LT(cv::norm(labels[0].centroid - first), 1.6) << turn_deg << " " << aside;
      EXPECT_LT(cv::norm(labels[1].centroid - second), 1.6) << turn_deg << " " << aside;
    }
  }
}

// The mouth all but shut: beyond the lip of the upper layer, whose label of 7 x 8 px shows whole,
// the lower layer's shows as a sliver as wide as `sliver`, shifted along the lip. Both are found
// where they are: the sliver is not given half of the whole label. 0.9 px: pixels are whole here,
// and the cut goes across the spot, not along the lip.
TEST(FindLabels, ASliverBeyondAWholeLabelIsOneOfItsOwn) {
  for (const int sliver : {2, 3}) {
    for (const int aside : {0, 2}) {
      for (const bool turned : {false, true}) {
        Masks masks;
        const int lip = 250 - sliver;  // The bag of Masks ends at 250.
        masks.label(cv::Rect(100, lip - 8, 7, 8)) = 255;
        masks.label(cv::Rect(100 + aside, lip, 7, sliver)) = 255;
        cv::Point2d whole(103, lip - 4.5), rest(103 + aside, lip + 0.5 * (sliver - 1));
        if (turned) {
          cv::flip(masks.label, masks.label, 0);
          cv::flip(masks.bag, masks.bag, 0);
          whole.y = 339 - whole.y;
          rest.y = 339 - rest.y;
        }
        const std::vector<Label> labels = FindLabels(masks.label, masks.bag, 10, kConfig);
        ASSERT_EQ(labels.size(), 2u) << sliver << " " << aside;
        EXPECT_LT(cv::norm(labels[0].centroid - whole), 0.9) << sliver << " " << aside;
        EXPECT_LT(cv::norm(labels[1].centroid - rest), 0.9) << sliver << " " << aside;
        EXPECT_NEAR(labels[1].area_px2, 7 * sliver, 7) << "by a row at most";
      }
    }
  }
}

// The lens spreads the edge of a sliver over two pixels on either side. What lies nearer to another
// spot belongs to that one.
TEST(FindLabels, TheSoftEdgeIsTwoPixelsWide) {
  Masks masks;
  masks.label(cv::Rect(58, 60, 1, 10)) = 26;
  masks.label(cv::Rect(59, 60, 1, 10)) = 77;
  masks.label(cv::Rect(60, 60, 1, 10)) = 128;
  masks.label(cv::Rect(61, 60, 1, 10)) = 51;
  std::vector<Label> labels = FindLabels(masks.label, masks.bag, 10, kConfig);
  ASSERT_EQ(labels.size(), 1u);
  EXPECT_NEAR(labels[0].area_px2, 10 * (0.1 + 0.3 + 0.5 + 0.2), 0.1);
  masks.label(cv::Rect(52, 61, 6, 8)) = 255;  // Its own edge is column 58.
  labels = FindLabels(masks.label, masks.bag, 10, kConfig);
  ASSERT_EQ(labels.size(), 2u);
  EXPECT_NEAR(labels[1].area_px2, 10 * (0.3 + 0.5 + 0.2), 0.1);
}

TEST(FindLabels, ARowOfThreeThatTouchIsThree) {
  Masks masks;
  for (const int x : {60, 68, 76}) masks.label(cv::Rect(x, 60, 7, 8)) = 255;
  masks.label(cv::Rect(60, 63, 23, 2)) = 255;
  EXPECT_EQ(FindLabels(masks.label, masks.bag, 10, kConfig).size(), 3u);
}

}  // namespace
}  // namespace gusset
