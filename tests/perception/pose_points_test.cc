#include "perception/pose_points.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

namespace gusset {
namespace {

const Quad kRect = {cv::Point2d(90, 0), cv::Point2d(0, 0), cv::Point2d(0, 180),
                    cv::Point2d(90, 180)};

TEST(PosePoints, CellCentresOfARectangleAreThoseOfItsCells) {
  const std::vector<cv::Point2d> points = CellCentres(kRect, 3);
  ASSERT_EQ(points.size(), 9u);
  EXPECT_LT(cv::norm(points[0] - cv::Point2d(75, 30)), 1e-9);  // At corner 0.
  EXPECT_LT(cv::norm(points[2] - cv::Point2d(15, 30)), 1e-9);  // At corner 1.
  EXPECT_LT(cv::norm(points[4] - cv::Point2d(45, 90)), 1e-9);
  EXPECT_LT(cv::norm(points[8] - cv::Point2d(15, 150)), 1e-9);  // At corner 2.
}

TEST(PosePoints, NineByNineCellsGive81PointsInside) {
  const Quad quad = {cv::Point2d(250, 25), cv::Point2d(85, 0), cv::Point2d(100, 208),
                     cv::Point2d(200, 218)};
  const std::vector<cv::Point2d> points = CellCentres(quad, 9);
  ASSERT_EQ(points.size(), 81u);
  const std::vector<cv::Point2f> border(quad.begin(), quad.end());
  for (const cv::Point2d& p : points) {
    EXPECT_GT(cv::pointPolygonTest(border, cv::Point2f(p), true), 3);
  }
}

TEST(PosePoints, RimPointsLieAtTheirShareOfTheLength) {
  const std::vector<cv::Point2d> points = RimPoints(kRect, 9);
  ASSERT_EQ(points.size(), 9u);
  for (int k = 0; k < 9; ++k) {
    EXPECT_NEAR(points[k].x, 85 - 10 * k, 1e-9);
    EXPECT_NEAR(points[k].y, 180 * 0.5 / 9, 1e-9);
  }
}

cv::Mat Disc(int radius) {
  cv::Mat mask = cv::Mat::zeros(100, 100, CV_8UC1);
  cv::circle(mask, {50, 50}, radius, 255, cv::FILLED);
  return mask;
}

TEST(SnapOnto, LeavesPointsOnTheClothAlone) {
  std::vector<cv::Point2d> points = {{50.25, 48.5}};
  SnapOnto(Disc(30), {0, 0}, 4, points);
  EXPECT_EQ(points[0], cv::Point2d(50.25, 48.5));
}

TEST(SnapOnto, MovesPointsToTheNearestPlaceInsideTheEdge) {
  std::vector<cv::Point2d> points = {{110, 150}, {140, 104}};
  SnapOnto(Disc(30), {100, 100}, 4, points);
  for (const cv::Point2d& p : points) {
    // At least 4 px (a square of 9 fits), so 26 from the middle, less at most a corner's excess.
    EXPECT_LE(cv::norm(p - cv::Point2d(150, 150)), 26.5);
    EXPECT_GE(cv::norm(p - cv::Point2d(150, 150)), 22);
  }
  EXPECT_LT(points[0].x, 135);  // On its own side of the disc.
  EXPECT_LT(points[1].y, 130);
}

TEST(SnapOnto, TakesAThinMaskAsItIs) {
  std::vector<cv::Point2d> points = {{80, 50}};
  SnapOnto(Disc(2), {0, 0}, 4, points);
  EXPECT_EQ(points[0], cv::Point2d(52, 50));
}

TEST(SnapOnto, AnEmptyMaskMovesNothing) {
  std::vector<cv::Point2d> points = {{80, 50}};
  SnapOnto(cv::Mat::zeros(100, 100, CV_8UC1), {0, 0}, 4, points);
  EXPECT_EQ(points[0], cv::Point2d(80, 50));
}

}  // namespace
}  // namespace gusset
