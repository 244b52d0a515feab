#include "perception/shapes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gusset {
namespace {

TEST(Shapes, AFilledContourHoldsItsBorderAndCountsFromTheBox) {
  const std::vector<cv::Point> square = {{12, 23}, {16, 23}, {16, 27}, {12, 27}};
  const cv::Mat mask = FilledContour(square, cv::Rect(10, 20, 9, 11));
  ASSERT_EQ(mask.size(), cv::Size(9, 11));
  EXPECT_EQ(cv::countNonZero(mask), 25);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(2, 3, 5, 5)) == 255), 25);
}

// Points evenly along a direction, and one to each side of the middle, nearer than the ends.
TEST(Shapes, ALineFollowsTheLongerAxisWhateverItsDirection) {
  for (int degrees = 0; degrees < 180; degrees += 15) {
    const double angle = degrees * CV_PI / 180;
    const cv::Point2d along(std::cos(angle), std::sin(angle)), across(-along.y, along.x);
    const cv::Point2d middle(40, 70);
    std::vector<cv::Point2d> points = {middle + 2 * across, middle - 2 * across};
    for (int k = -3; k <= 3; ++k) points.push_back(middle + 5.0 * k * along);
    const FittedLine line = FitLine(points);
    EXPECT_NEAR(cv::norm(line.mean - middle), 0, 1e-12);
    EXPECT_NEAR(std::abs(line.along.dot(along)), 1, 1e-12) << degrees;
    EXPECT_NEAR(line.least, -15, 1e-12);
    EXPECT_NEAR(line.most, 15, 1e-12);
  }
}

}  // namespace
}  // namespace gusset
