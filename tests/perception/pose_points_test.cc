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

std::vector<cv::Point> Square(int half, cv::Point centre) {
  std::vector<cv::Point> contour;
  for (int k = -half; k < half; ++k) {
    for (const cv::Point& p :
         {cv::Point(k, -half), cv::Point(half, k), cv::Point(-k, half), cv::Point(-half, -k)}) {
      contour.push_back(centre + p);
    }
  }
  return contour;
}

TEST(EdgePoints, AreTheCornersWithinTheConeAndElseItsRim) {
  const cv::Point2d centre(100, 80);
  const std::vector<cv::Point> square = Square(40, centre);
  const double diagonal = 40 * std::sqrt(2);
  const std::vector<cv::Point2d> points = {
      {120, 70},  // 26.6 degrees off the axis, 18.4 off the corner.
      {120, 80},  // On the axis: the corners are 45 degrees away.
  };
  const auto wide = EdgePoints(square, {0, 0}, centre, points, 25 * CV_PI / 180, 9, 15);
  EXPECT_LT(cv::norm(wide[0] - (centre + (diagonal - 9) / diagonal * cv::Point2d(40, -40))), 1e-9);
  EXPECT_NEAR(cv::norm(wide[1] - centre), 40 / std::cos(25 * CV_PI / 180) - 9, 0.8);
  const auto narrow = EdgePoints(square, {0, 0}, centre, points, 2 * CV_PI / 180, 0, 15);
  EXPECT_NEAR(narrow[1].x, 140, 1e-9);
  EXPECT_NEAR(narrow[1].y, 80, 40 * std::tan(2 * CV_PI / 180));
}

TEST(EdgePoints, LeaveWhatHasNoSide) {
  const cv::Point2d centre(100, 80);
  const std::vector<cv::Point2d> points = {{114, 80}, centre, {100, 60}};
  EXPECT_EQ(EdgePoints(Square(40, centre), {0, 0}, centre, points, 0.4, 9, 15)[0], points[0]);
  EXPECT_EQ(EdgePoints(Square(40, centre), {0, 0}, centre, points, 0.4, 9, 0)[1], points[1]);
  EXPECT_EQ(EdgePoints({}, {0, 0}, centre, points, 0.4, 9, 15)[2], points[2]);
  // A contour that lies to the right only.
  EXPECT_EQ(EdgePoints({{140, 79}, {141, 80}, {140, 81}}, {0, 0}, centre, points, 0.4, 9, 15)[2],
            points[2]);
  // Closer than the inset: no further than the centre.
  EXPECT_EQ(EdgePoints({{90, 70}}, {10, 5}, centre, points, 0.4, 9, 15)[2], centre);
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
