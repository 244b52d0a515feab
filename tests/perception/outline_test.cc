#include "perception/outline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace gusset {
namespace {

using Points = std::vector<cv::Point2d>;

/// A convex four-sided figure whose corners are listed as Outline lists them.
const Points kBody = {{90, -80}, {-100, -70}, {-95, 85}, {80, 75}};

Points Turned(const Points& points, double yaw, cv::Point2d to = {200, 150}) {
  Points turned;
  for (const cv::Point2d& p : points) {
    turned.push_back(to + cv::Point2d(std::cos(yaw) * p.x + std::sin(yaw) * p.y,
                                      -std::sin(yaw) * p.x + std::cos(yaw) * p.y));
  }
  return turned;
}

std::vector<cv::Point2f> Contour(const Points& points) {
  return std::vector<cv::Point2f>(points.begin(), points.end());
}

TEST(Outline, FindsTheCornersOfAFourSidedBodyAtAnyYaw) {
  for (double yaw = -3; yaw < 3; yaw += 0.1) {
    const Points body = Turned(kBody, yaw);
    const Outline outline = FitOutline(Contour(body));
    const cv::Point2d outward = Turned({{0, -1}}, yaw, {0, 0})[0];
    const Outline counted = outline.From(SideTowards(outline, outward));
    for (int k = 0; k < 4; ++k) {
      EXPECT_LT(cv::norm(counted.corners[k] - body[k]), 1e-4) << yaw;  // Single precision.
    }
  }
}

TEST(Outline, CentroidIsThatOfTheArea) {
  // A triangle's corners and its centre of area.
  const Outline outline = FitOutline(Contour({{0, 0}, {60, 0}, {0, 30}}));
  EXPECT_NEAR(outline.centroid.x, 20, 1e-9);
  EXPECT_NEAR(outline.centroid.y, 10, 1e-9);
}

TEST(Outline, WithoutAreaItStaysFinite) {
  const Outline outline = FitOutline(Contour({{3, 4}, {9, 4}, {30, 4}}));
  EXPECT_NEAR(outline.centroid.x, 14, 1e-9);
  for (const cv::Point2d& corner : outline.corners) EXPECT_TRUE(std::isfinite(corner.x));
}

TEST(Outline, EveryCornerIsAPointOfTheContourEvenOfATriangle) {
  const Points triangle = {{0, -40}, {-60, 30}, {55, 35}};
  for (double yaw = 0; yaw < 6.2; yaw += 0.3) {
    const Points turned = Turned(triangle, yaw);
    for (const cv::Point2d& corner : FitOutline(Contour(turned)).corners) {
      double nearest = 1e9;
      for (const cv::Point2d& p : turned) nearest = std::min(nearest, cv::norm(p - corner));
      EXPECT_LT(nearest, 1e-4);
    }
  }
}

// The largest quadrilateral in a convex body has at least 2 / pi of its area, an ellipse's no more
// (Sas 1939, Compositio Math. 6, p. 468).
TEST(Outline, CoversTwoOverPiOfAnyConvexBody) {
  const auto area = [](const Outline& outline) {
    double twice = 0;
    for (int k = 0; k < 4; ++k) twice += outline.corners[(k + 1) % 4].cross(outline.corners[k]);
    return 0.5 * twice;
  };
  for (double ratio = 0.3; ratio <= 1; ratio += 0.1) {
    Points ellipse;
    for (int k = 0; k < 60; ++k) {
      const double t = k * CV_PI / 30;
      ellipse.emplace_back(100 * std::cos(t), 100 * ratio * std::sin(t));
    }
    const double whole = CV_PI * 100 * 100 * ratio;
    EXPECT_NEAR(area(FitOutline(Contour(Turned(ellipse, ratio)))) / whole, 2 / CV_PI, 1e-4);
  }
  const Points kite = {{0, -90}, {-35, 20}, {-20, 60}, {0, 80}, {20, 60}, {35, 20}};
  const double whole = cv::contourArea(Contour(kite));
  for (double yaw = 0; yaw < 6.2; yaw += 0.3) {
    EXPECT_GT(area(FitOutline(Contour(Turned(kite, yaw)))), 2 / CV_PI * whole);
  }
}

TEST(Outline, UpperRightCornerDoesNotDependOnPosition) {
  const Points body = Turned(kBody, 0.4, {0, 0});
  const int corner = UpperRightCorner(FitOutline(Contour(body)));
  for (const cv::Point2d to : {cv::Point2d(300, 10), cv::Point2d(10, 300)}) {
    EXPECT_EQ(UpperRightCorner(FitOutline(Contour(Turned(kBody, 0.4, to)))), corner);
  }
}

TEST(Outline, UprightBodyCountsFromItsUpperRightToItsUpperLeft) {
  const Outline outline = FitOutline(Contour(Turned(kBody, 0)));
  const Outline counted = outline.From(UpperRightCorner(outline));
  EXPECT_LT(cv::norm(counted.corners[0] - cv::Point2d(290, 70)), 1e-4);
  EXPECT_LT(cv::norm(counted.corners[1] - cv::Point2d(100, 80)), 1e-4);
}

TEST(Outline, SideTowardsIsTheOneThatLooksThatWay) {
  const Outline outline = FitOutline(Contour(Turned(kBody, 0)));
  const Outline counted = outline.From(SideTowards(outline, {0.1, 1}));
  EXPECT_GT(counted.normals[0].y, 0.9);
  EXPECT_LT(cv::norm(counted.corners[0] - cv::Point2d(105, 235)), 1e-4);
}

}  // namespace
}  // namespace gusset
