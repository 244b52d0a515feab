#include "perception/rim.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

using Points = std::vector<cv::Point2d>;
using synthetic::kHalfDepth;
using synthetic::kHalfWidth;
using synthetic::Pose;

constexpr double kReach_px = 20;
constexpr double kDegree = CV_PI / 180;

Points At(const Pose& pose, const Points& points) {
  Points turned;
  for (const cv::Point2d& p : points) turned.push_back(pose(p.x, p.y));
  return turned;
}

std::vector<cv::Point> Rounded(const Points& points) {
  std::vector<cv::Point> rounded;
  for (const cv::Point2d& p : points) rounded.emplace_back(cvRound(p.x), cvRound(p.y));
  return rounded;
}

cv::Mat Mask(const Points& polygon) {
  cv::Mat mask = cv::Mat::zeros(480, 640, CV_8UC1);
  cv::fillPoly(mask, std::vector<std::vector<cv::Point>>{Rounded(polygon)}, 255);
  return mask;
}

// The rim at the top; counted against the clock as one sees it, from the upper right.
const Points kFlat = {{kHalfWidth, -kHalfDepth},
                      {-kHalfWidth, -kHalfDepth},
                      {-kHalfWidth, kHalfDepth},
                      {kHalfWidth, kHalfDepth}};

double AngleBetween(cv::Point2d a, cv::Point2d b) {
  return std::abs(std::atan2(a.cross(b), a.dot(b)));
}

TEST(Rim, LooksAwayFromTheClothAtItsLabels) {
  const Points labels = {{-69, -97}, {-35, -97}, {0, -97}, {35, -97}, {69, -97}};
  for (double yaw = -3; yaw < 3; yaw += 0.17) {
    const Pose pose{{320, 240}, yaw};
    const cv::Point2d seen =
        RimDirection(Mask(At(pose, kFlat)), At(pose, labels), {0, 0}, kReach_px);
    EXPECT_NEAR(cv::norm(seen), 1, 1e-12);
    EXPECT_LT(AngleBetween(seen, pose(0, -1) - pose(0, 0)), 3 * kDegree) << yaw;
  }
}

TEST(Rim, LabelsOfTheLayerThatWasDrawnBackDoNotTurnIt) {
  for (double yaw = -3; yaw < 3; yaw += 0.5) {
    const Pose pose{{310, 250}, yaw};
    // The drawn lip lies to one side of the rim's middle: amid cloth, its labels say nothing.
    const Points rim = {{-64, -95}, {-32, -96}, {0, -96}, {32, -96}, {64, -95}};
    Points all = rim;
    for (const cv::Point2d& drawn : Points{{30, -40}, {50, -30}, {55, -60}}) all.push_back(drawn);
    const cv::Mat bag = Mask(At(pose, kFlat));
    EXPECT_LT(AngleBetween(RimDirection(bag, At(pose, all), {0, 0}, kReach_px),
                           RimDirection(bag, At(pose, rim), {0, 0}, kReach_px)),
              2 * kDegree);
  }
}

TEST(Rim, DirectionDoesNotDependOnWhereTheMaskBegins) {
  const Pose pose{{320, 240}, 0.4};
  const cv::Mat whole = Mask(At(pose, kFlat));
  const Points labels = At(pose, {{-35, -97}, {0, -97}, {35, -97}});
  const cv::Point2d seen = RimDirection(whole, labels, {0, 0}, kReach_px);
  const cv::Rect roi(150, 70, 340, 340);
  EXPECT_LT(AngleBetween(seen, RimDirection(whole(roi), labels, roi.tl(), kReach_px)), 1e-9);
}

TEST(Rim, AmidClothAndOutsideOfItTheDirectionStaysAUnitVector) {
  const cv::Mat cloth(100, 100, CV_8UC1, cv::Scalar(255));
  EXPECT_NEAR(cv::norm(RimDirection(cloth, {{50, 50}}, {0, 0}, kReach_px)), 1, 1e-12);
  EXPECT_NEAR(cv::norm(RimDirection(cloth, {{500, 50}}, {0, 0}, kReach_px)), 1, 1e-12);
}

// One end of the rim is folded under, and the largest quadrilateral has a side across the corner
// that is missing.
TEST(Rim, CornersLieAlongTheLabelsThoughAFoldHidesTheRimsEnd) {
  const Points folded = {{20, -kHalfDepth},
                         {-kHalfWidth, -kHalfDepth},
                         {-kHalfWidth, kHalfDepth},
                         {kHalfWidth, kHalfDepth},
                         {kHalfWidth, 20}};
  const Points row = {{-69, -97}, {-35, -97}, {-1, -97}};
  for (double yaw = -3; yaw < 3; yaw += 0.25) {
    const Pose pose{{320, 240}, yaw};
    const Outline outline = FitOutline(Rounded(At(pose, folded)));
    const cv::Point2d outward = pose(0, -1) - pose(0, 0);
    const auto corners = CornersFromRow(outline, At(pose, row), outward, 4);
    // Half a spacing of 34 px beyond the labels at the ends, 4 px outside of them.
    const Points expected =
        At(pose, {{16, -101}, {-86, -101}, {-kHalfWidth, kHalfDepth}, {kHalfWidth, kHalfDepth}});
    for (int k = 0; k < 4; ++k) EXPECT_LT(cv::norm(corners[k] - expected[k]), 1.5) << yaw << k;
  }
}

TEST(Rim, OnAFlatBagCornersAreTheBagsOwn) {
  const Points row = {{-69, -97}, {-35, -97}, {0, -97}, {35, -97}, {69, -97}};
  for (double yaw = -3; yaw < 3; yaw += 0.25) {
    const Pose pose{{320, 240}, yaw};
    const Outline outline = FitOutline(Rounded(At(pose, kFlat)));
    const auto corners = CornersFromRow(outline, At(pose, row), pose(0, -1) - pose(0, 0), 4);
    const Points expected = At(pose, kFlat);
    for (int k = 0; k < 4; ++k) EXPECT_LT(cv::norm(corners[k] - expected[k]), 1.5) << yaw << k;
  }
}

}  // namespace
}  // namespace gusset
