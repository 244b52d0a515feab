#include "perception/mouth_outline.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/random.h"

namespace gusset {
namespace {

using Points = std::vector<cv::Point2d>;

double Length(const Points& way) {
  double length = 0;
  for (std::size_t i = 0; i < way.size(); ++i) {
    length += cv::norm(way[i] - way[(i + 1) % way.size()]);
  }
  return length;
}

// By trying every order of all points but the first.
double ShortestLength(Points points) {
  const auto before = [](cv::Point2d a, cv::Point2d b) {
    return a.x != b.x ? a.x < b.x : a.y < b.y;
  };
  std::sort(points.begin(), points.end(), before);
  double shortest = std::numeric_limits<double>::infinity();
  do {
    shortest = std::min(shortest, Length(points));
  } while (std::next_permutation(points.begin() + 1, points.end(), before));
  return shortest;
}

// Labels of two lips 16 px apart round a folded corner.
Points BentMouth() {
  return {{100, 100}, {140, 100}, {180, 100}, {180, 140}, {180, 180},
          {100, 116}, {132, 116}, {164, 116}, {164, 148}, {164, 180}};
}

TEST(MouthOutline, OfARingIsTheRing) {
  Points ring;
  for (int i = 0; i < 10; ++i) {
    const double angle = 2 * std::numbers::pi * i / 10;
    ring.emplace_back(240 + 60 * std::cos(angle), 240 + 40 * std::sin(angle));
  }
  Points shuffled = ring;
  Rng rng(1);
  rng.Shuffle(shuffled);
  EXPECT_NEAR(Length(MouthOutline(shuffled)), Length(ring), 1e-9);
}

TEST(MouthOutline, IsTheShortestWayRoundSevenPoints) {
  Rng rng(2);
  int shortest = 0;
  const int trials = 100;
  for (int trial = 0; trial < trials; ++trial) {
    Points points;
    for (int i = 0; i < 7; ++i) points.emplace_back(rng.Uniform(0, 100), rng.Uniform(0, 100));
    const double length = Length(MouthOutline(points)), best = ShortestLength(points);
    EXPECT_GE(length, best - 1e-9);
    EXPECT_LE(length, 1.1 * best);
    shortest += length <= best + 1e-9 ? 1 : 0;
  }
  EXPECT_GE(shortest, 0.95 * trials);
}

TEST(MouthOutline, LeavesOutTheClothBetweenTheArmsOfABentMouth) {
  Points mouth = MouthOutline(BentMouth());
  std::vector<cv::Point2f> outline(mouth.begin(), mouth.end()), hull;
  cv::convexHull(outline, hull);
  EXPECT_NEAR(cv::contourArea(outline), 16 * (80 + 64), 200) << "a corner may be cut";
  EXPECT_GT(cv::contourArea(hull), 4000);
  EXPECT_LT(cv::pointPolygonTest(outline, {145, 140}, false), 0);
  EXPECT_GT(cv::pointPolygonTest(hull, {145, 140}, false), 0);
}

TEST(MouthOutline, DoesNotDependOnTheOrderOfItsPoints) {
  Rng rng(3);
  Points points = BentMouth();
  const Points first = MouthOutline(points);
  for (int trial = 0; trial < 20; ++trial) {
    rng.Shuffle(points);
    EXPECT_EQ(MouthOutline(points), first);
  }
}

TEST(MouthOutline, TakesPointsOnALineTwiceOrTooFew) {
  EXPECT_EQ(MouthOutline({}).size(), 0u);
  EXPECT_EQ(MouthOutline({{1, 2}, {1, 2}, {1, 2}}).size(), 1u);
  EXPECT_EQ(MouthOutline({{1, 2}, {3, 4}}).size(), 2u);
  const Points line = MouthOutline({{0, 0}, {30, 0}, {10, 0}, {20, 0}});
  EXPECT_EQ(line.size(), 4u);
  EXPECT_DOUBLE_EQ(Length(line), 60);
  EXPECT_THROW(MouthOutline({{0, 0}, {1, std::nan("")}, {2, 2}}), InputError);
}

// Labels 30 px apart on one lip that is bent by a right angle.
Points BentLip() {
  Points lip = {{100, 250}, {130, 250}, {160, 250}, {190, 250}};
  for (int y = 220; y >= 100; y -= 30) lip.emplace_back(190, y);
  return lip;
}

TEST(GoesRound, TellsASingleBentLipFromAMouth) {
  EXPECT_FALSE(GoesRound(MouthOutline(BentLip())));
  EXPECT_TRUE(GoesRound(MouthOutline(BentMouth())));
}

TEST(GoesRound, AllowsForAHiddenLabelButNotForTwoInARow) {
  Points ring;
  for (int i = 0; i < 10; ++i) {
    const double angle = 2 * std::numbers::pi * i / 10;
    ring.emplace_back(240 + 60 * std::cos(angle), 240 + 60 * std::sin(angle));
  }
  EXPECT_TRUE(GoesRound(ring));
  ring.erase(ring.begin() + 4);
  EXPECT_TRUE(GoesRound(ring));
  ring.erase(ring.begin() + 4);  // 2.6 times the others
  EXPECT_FALSE(GoesRound(ring));
}

// An arch of labels, the same gap in its way back: once as it is, once as a row that goes to and
// fro.
TEST(GoesRound, BelievesLessOfAGapTheMoreTheOutlineWinds) {
  const Points arch = {{0, 0}, {30, -20}, {60, -20}, {90, 0}, {90, 30}, {65, 45}, {0, 45}};
  const Points comb = {{0, 0},  {30, 0},  {30, 30}, {60, 30}, {60, 0},
                       {90, 0}, {90, 60}, {60, 65}, {30, 65}, {0, 65}};
  EXPECT_TRUE(GoesRound(arch));
  EXPECT_FALSE(GoesRound(comb)) << "a side of 65 among sides of 30, turned by twice round";
}

TEST(GoesRound, CannotBeToldOfFewerThanFourPoints) {
  EXPECT_TRUE(GoesRound({{0, 0}, {1, 0}, {100, 1}}));
  EXPECT_TRUE(GoesRound({}));
  EXPECT_FALSE(GoesRound({{0, 0}, {10, 0}, {20, 0}, {30, 0}})) << "the way back is a side";
  EXPECT_THROW(GoesRound({{0, 0}, {1, std::nan("")}, {2, 2}}), InputError);
}

// Room as a mask of the whole box.
cv::Mat RoomIn(const Points& outline, const cv::Rect& box, double radius_px) {
  const MouthDepth depth = DepthWithin(outline, box);
  cv::Mat room = cv::Mat::zeros(box.size(), CV_8UC1);
  const cv::Mat part = RoomWithin(depth, radius_px);
  if (!part.empty()) part.copyTo(room(depth.part - box.tl()));
  return room;
}

std::optional<MouthWidth> WidthIn(const Points& outline, const cv::Rect& box) {
  return MeasureWidth(outline, DepthWithin(outline, box));
}

TEST(RoomWithin, IsWhereADiscFits) {
  const cv::Rect box(100, 50, 200, 150);
  const Points square = {{150, 80}, {230, 80}, {230, 160}, {150, 160}};
  const cv::Mat room = RoomIn(square, box, 15);
  ASSERT_EQ(room.size(), box.size());
  // A square of 80, its border included, less 15 at every side.
  const cv::Rect found = cv::boundingRect(room);
  EXPECT_NEAR(found.x, 150 + 15 - 100, 1);
  EXPECT_NEAR(found.y, 80 + 15 - 50, 1);
  EXPECT_NEAR(found.width, 51, 2);
  EXPECT_NEAR(found.height, 51, 2);
}

TEST(RoomWithin, OfANarrowMouthIsWhatLiesFarthestInside) {
  const cv::Rect box(0, 0, 200, 200);
  const Points slit = {{20, 90}, {180, 90}, {180, 100}, {20, 100}};
  const cv::Mat room = RoomIn(slit, box, 18);
  Points inside;
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (room.at<uchar>(y, x) != 0) inside.emplace_back(x, y);
    }
  }
  ASSERT_FALSE(inside.empty());
  for (const cv::Point2d& p : inside) EXPECT_NEAR(p.y, 95, 0.6);
}

TEST(RoomWithin, EndsAtTheImagesEdgeAndIsNothingForTwoPoints) {
  const cv::Rect box(0, 0, 100, 100);
  const cv::Mat room = RoomIn({{-50, -50}, {150, -50}, {150, 150}, {-50, 150}}, box, 10);
  EXPECT_EQ(room.at<uchar>(5, 50), 0);
  EXPECT_NE(room.at<uchar>(50, 50), 0);
  EXPECT_EQ(cv::countNonZero(RoomIn({{10, 10}, {50, 50}}, box, 10)), 0);
}

TEST(ShareOutside, IsWhatOfTheMouthTheMaskLeavesOut) {
  const Points square = {{150, 80}, {229, 80}, {229, 159}, {150, 159}};  // 80 x 80 pixels
  const MouthDepth depth = DepthWithin(square, {100, 50, 200, 150});
  cv::Mat mask(150, 200, CV_8UC1, cv::Scalar(255));
  EXPECT_EQ(ShareOutside(depth, mask, {100, 50}), 0);
  mask(cv::Rect(150 - 100, 80 - 50, 20, 40)) = 0;  // within it
  mask(cv::Rect(0, 0, 40, 150)) = 0;               // beside it
  EXPECT_NEAR(ShareOutside(depth, mask, {100, 50}), 20. * 40 / (80 * 80), 1e-12);
  cv::Mat whole(150, 200, CV_8UC1, cv::Scalar(255));
  EXPECT_NEAR(ShareOutside(depth, whole, {190, 80}), 0.5, 1e-12) << "the mask begins half-way";
  EXPECT_EQ(ShareOutside(depth, mask, {1000, 1000}), 1);
  EXPECT_EQ(ShareOutside(MouthDepth{}, mask, {0, 0}), 0);
  EXPECT_THROW(ShareOutside(depth, cv::Mat(), {0, 0}), InputError);
}

TEST(MeasureWidth, OfASlitIsItsWidthAcrossHoweverItIsTurned) {
  const cv::Rect box(20, 30, 300, 300);
  const double long_px = 120, wide_px = 24;
  for (int degree = 0; degree < 180; degree += 15) {
    const double turn = degree * std::numbers::pi / 180;
    const cv::Point2d centre(170, 180), along(std::cos(turn), std::sin(turn));
    const cv::Point2d across(-along.y, along.x);
    Points slit;
    for (const auto& [a, b] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}) {
      slit.push_back(centre + a * long_px / 2 * along + b * wide_px / 2 * across);
    }
    const auto width = WidthIn(slit, box);
    ASSERT_TRUE(width.has_value());
    EXPECT_NEAR(width->radius_px, wide_px / 2, 1.5);
    EXPECT_NEAR(width->length_px, long_px, 1.5);
    EXPECT_NEAR(cv::norm(0.5 * (width->sides[0] + width->sides[1]) - centre), 0, 1.5);
    EXPECT_NEAR(std::abs((width->sides[0] - width->sides[1]).dot(across)), wide_px, 3);
    EXPECT_NEAR((width->sides[0] - width->sides[1]).dot(along), 0, 2);
  }
}

TEST(MeasureWidth, OfABentMouthIsMeasuredWhereThereIsMouth) {
  const auto width = WidthIn(MouthOutline(BentMouth()), {0, 0, 300, 300});
  ASSERT_TRUE(width.has_value());
  // As wide as an arm, or wider in the bend, whose inner corner is cut: to the circle that touches
  // the outer sides and the cut, (132, 116) to (164, 148), 45.3 px from the outer corner.
  EXPECT_GE(width->radius_px, 7.5);
  EXPECT_LE(width->radius_px, 45.3 / (1 + std::numbers::sqrt2) + 1);
  const Points mouth = MouthOutline(BentMouth());
  const std::vector<cv::Point2f> outline(mouth.begin(), mouth.end());
  for (const cv::Point2d& side : width->sides) {
    EXPECT_NEAR(cv::pointPolygonTest(outline, side, /*measureDist=*/true), 0, 2.5);
  }
}

TEST(MeasureWidth, IsNoneWhereThereIsNoMouth) {
  const cv::Rect box(0, 0, 100, 100);
  EXPECT_FALSE(WidthIn({}, box));
  EXPECT_FALSE(WidthIn({{10, 10}, {50, 50}}, box));
  EXPECT_FALSE(WidthIn({{200, 200}, {300, 200}, {300, 300}}, box));
}

}  // namespace
}  // namespace gusset
