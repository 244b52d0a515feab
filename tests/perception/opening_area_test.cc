#include "perception/opening_area.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/random.h"

namespace gusset {
namespace {

using Points = std::vector<cv::Point2d>;

Points RandomPoints(int count, std::uint64_t seed) {
  Rng rng(seed);
  Points points;
  for (int k = 0; k < count; ++k) {
    const double x = rng.Uniform(0, 100);
    points.emplace_back(x, rng.Uniform(0, 80));
  }
  return points;
}

Points Shuffled(Points points, std::uint64_t seed) {
  Rng rng(seed);
  for (int k = static_cast<int>(points.size()) - 1; k > 0; --k) {
    std::swap(points[k], points[rng.Below(k + 1)]);
  }
  return points;
}

/// Area and centroid of the union by drawing the triangles `scale` times enlarged.
Opening Rasterised(const Opening& opening, double scale) {
  cv::Mat image = cv::Mat::zeros(static_cast<int>(100 * scale), static_cast<int>(120 * scale), 0);
  for (const Triangle& triangle : opening.triangles) {
    std::vector<cv::Point> fixed;
    for (const cv::Point2d& p : triangle) {
      fixed.emplace_back(cvRound((p.x + 5) * scale * 16), cvRound((p.y + 5) * scale * 16));
    }
    cv::fillConvexPoly(image, fixed, 255, cv::LINE_8, 4);
  }
  const cv::Moments moments = cv::moments(image, true);
  Opening drawn;
  drawn.area_px2 = moments.m00 / scale / scale;
  drawn.centre = {moments.m10 / moments.m00 / scale - 5, moments.m01 / moments.m00 / scale - 5};
  return drawn;
}

TEST(OpeningArea, FewerThanThreeLabelsHaveNone) {
  EXPECT_EQ(MeasureOpening({}).area_px2, 0);
  EXPECT_EQ(MeasureOpening({{1, 2}}).area_px2, 0);
  const Opening two = MeasureOpening({{0, 0}, {4, 2}});
  EXPECT_EQ(two.area_px2, 0);
  EXPECT_EQ(two.centre, cv::Point2d(2, 1));
  EXPECT_TRUE(two.triangles.empty());
}

// Three points give one round: two of the three triangles that the centroid cuts the figure into,
// each a third of it.
TEST(OpeningArea, OfThreePointsIsTwoThirdsOfTheirTriangle) {
  const Opening opening = MeasureOpening({{0, 0}, {40, 0}, {7, 30}});
  EXPECT_EQ(opening.triangles.size(), 2u);
  EXPECT_NEAR(opening.area_px2, 2. / 3 * 600, 1e-9);
}

// Two rounds: both sides at the first corner, one more at the second; the fourth triangle is the
// diagonal.
TEST(OpeningArea, OfASquareIsThreeQuartersOfIt) {
  const Opening opening = MeasureOpening({{0, 0}, {0, 20}, {20, 0}, {20, 20}});
  EXPECT_EQ(opening.triangles.size(), 4u);
  EXPECT_NEAR(opening.area_px2, 300, 1e-9);
}

TEST(OpeningArea, NRoundsGiveTwoTrianglesEach) {
  for (int n = 3; n < 12; ++n) {
    EXPECT_EQ(MeasureOpening(RandomPoints(n, n)).triangles.size(), 2u * (n - 2));
  }
}

TEST(OpeningArea, NoTriangleHasAPointTwice) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    for (const Triangle& t : MeasureOpening(RandomPoints(10, seed)).triangles) {
      EXPECT_NE(t[1], t[2]);
    }
  }
}

TEST(OpeningArea, LabelsInALineHaveNone) {
  const Opening opening = MeasureOpening({{0, 0}, {10, 5}, {20, 10}, {30, 15}, {40, 20}});
  EXPECT_NEAR(opening.area_px2, 0, 1e-6);
  EXPECT_NEAR(opening.centre.x, 20, 1e-9);
}

TEST(OpeningArea, CoincidentLabelsStayFinite) {
  EXPECT_EQ(MeasureOpening(Points(5, {3, 3})).area_px2, 0);
  const Opening opening = MeasureOpening({{0, 0}, {0, 0}, {10, 0}, {10, 0}, {5, 8}});
  EXPECT_TRUE(std::isfinite(opening.area_px2));
  EXPECT_LE(opening.area_px2, 40 + 1e-9);  // Their triangle.
}

// A border pixel more or less along at most 28 triangle sides of at most 130 px, drawn 8 times
// enlarged: 1 % of areas of some thousands.
TEST(OpeningArea, IsTheAreaOfTheUnionAsDrawn) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Opening opening = MeasureOpening(RandomPoints(3 + seed % 13, seed));
    const Opening drawn = Rasterised(opening, 8);
    EXPECT_NEAR(opening.area_px2, drawn.area_px2, 0.01 * drawn.area_px2 + 20) << seed;
    EXPECT_NEAR(opening.centre.x, drawn.centre.x, 0.3) << seed;
    EXPECT_NEAR(opening.centre.y, drawn.centre.y, 0.3) << seed;
  }
}

TEST(OpeningArea, LiesBetweenTheLargestTriangleAndTheSumAndTheHull) {
  for (std::uint64_t seed = 100; seed < 140; ++seed) {
    const Points points = RandomPoints(10, seed);
    const Opening opening = MeasureOpening(points);
    double largest = 0;
    double sum = 0;
    for (const Triangle& t : opening.triangles) {
      const double area = 0.5 * std::abs((t[1] - t[0]).cross(t[2] - t[0]));
      largest = std::max(largest, area);
      sum += area;
    }
    std::vector<cv::Point2f> hull;
    cv::convexHull(std::vector<cv::Point2f>(points.begin(), points.end()), hull);
    EXPECT_GE(opening.area_px2, largest - 1e-9);
    EXPECT_LE(opening.area_px2, sum + 1e-9);
    EXPECT_LE(opening.area_px2, cv::contourArea(hull) + 1e-2);  // The hull is in single precision.
  }
}

TEST(OpeningArea, IsTheSameBitForBitForAnyOrder) {
  Points points = RandomPoints(10, 7);
  points.push_back(points.front());
  const Opening opening = MeasureOpening(points);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Opening shuffled = MeasureOpening(Shuffled(points, seed));
    EXPECT_EQ(shuffled.area_px2, opening.area_px2);
    EXPECT_EQ(shuffled.centre, opening.centre);
    EXPECT_EQ(shuffled.triangles, opening.triangles);
  }
}

TEST(OpeningArea, WithoutTiesItDoesNotDependOnWhereTheBagLies) {
  const Points points = RandomPoints(9, 3);
  const double area = MeasureOpening(points).area_px2;
  for (double yaw = 0.1; yaw < 6.3; yaw += 0.5) {
    Points moved;
    for (const cv::Point2d& p : points) {
      moved.emplace_back(30 + std::cos(yaw) * p.x + std::sin(yaw) * p.y,
                         -9 + std::sin(yaw) * p.x - std::cos(yaw) * p.y);
    }
    // Round-off alone.
    EXPECT_NEAR(MeasureOpening(moved).area_px2, area, 1e-9 * area);
  }
}

}  // namespace
}  // namespace gusset
