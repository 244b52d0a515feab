#include "perception/bag_body.h"

#include <gtest/gtest.h>

namespace gusset {
namespace {

const PerceptionConfig kConfig;

cv::Mat Mask() { return cv::Mat::zeros(340, 340, CV_8UC1); }

TEST(FindBag, AreaIsThatOfTheBody) {
  cv::Mat cloth = Mask();
  cloth(cv::Rect(80, 70, 173, 202)) = 255;
  const std::optional<BagBody> bag = FindBag(cloth, kConfig);
  ASSERT_TRUE(bag);
  EXPECT_EQ(bag->area_px2, 173 * 202);
  EXPECT_FALSE(bag->at_border);
}

TEST(FindBag, NothingAndSpecksAreNoBag) {
  cv::Mat cloth = Mask();
  EXPECT_FALSE(FindBag(cloth, kConfig));
  for (int y = 5; y < 330; y += 9) {
    for (int x = 5; x < 330; x += 9) cloth(cv::Rect(x, y, 2, 2)) = 255;
  }
  EXPECT_FALSE(FindBag(cloth, kConfig));
}

TEST(FindBag, ATableIsNoBag) { EXPECT_FALSE(FindBag(Mask() == 0, kConfig)); }

TEST(FindBag, TheLargestBodyIsTheBag) {
  cv::Mat cloth = Mask();
  cloth(cv::Rect(10, 10, 60, 60)) = 255;
  cloth(cv::Rect(150, 150, 100, 120)) = 255;
  EXPECT_EQ(FindBag(cloth, kConfig)->area_px2, 100 * 120);
}

TEST(FindBag, ADarkCreaseDoesNotBreakTheBody) {
  cv::Mat cloth = Mask();
  cloth(cv::Rect(80, 70, 173, 202)) = 255;
  cloth(cv::Rect(80, 160, 173, 5)) = 0;
  EXPECT_EQ(FindBag(cloth, kConfig)->area_px2, 173 * 202);
}

TEST(FindBag, ADarkMouthIsFilledButALoopOfClothIsNot) {
  cv::Mat cloth = Mask();
  cloth(cv::Rect(80, 70, 173, 202)) = 255;
  cloth(cv::Rect(120, 120, 30, 30)) = 0;
  EXPECT_EQ(FindBag(cloth, kConfig)->area_px2, 173 * 202);
  cloth(cv::Rect(120, 120, 80, 80)) = 0;
  EXPECT_EQ(FindBag(cloth, kConfig)->area_px2, 173 * 202 - 80 * 80);
}

// It looks where there is cloth: with specks in the corners that is everywhere.
TEST(FindBag, SeesTheSameHoweverMuchItLooksAt) {
  for (const cv::Point at :
       {cv::Point(0, 0), {1, 2}, {80, 70}, {338 - 173, 337 - 202}, {167, 138}}) {
    cv::Mat cloth = Mask();
    cloth(cv::Rect(at, cv::Size(173, 202))) = 255;
    cloth(cv::Rect(at.x + 40, at.y, 5, 150)) = 0;       // closed
    cloth(cv::Rect(at.x + 90, at.y + 60, 60, 60)) = 0;  // a hole
    const std::optional<BagBody> alone = FindBag(cloth, kConfig);
    for (const cv::Point corner : {cv::Point(0, 0), {337, 0}, {0, 337}, {337, 337}}) {
      const cv::Rect speck(corner, cv::Size(2, 2));
      if ((speck & cv::Rect(at, cv::Size(173, 202))).empty()) cloth(speck) = 255;
    }
    const std::optional<BagBody> among = FindBag(cloth, kConfig);
    ASSERT_TRUE(alone && among);
    EXPECT_EQ(cv::countNonZero(alone->mask != among->mask), 0) << at;
    EXPECT_EQ(alone->contour, among->contour) << at;
    EXPECT_EQ(alone->at_border, among->at_border) << at;
    EXPECT_LT(alone->area_px2, 174 * 203 - 50 * 50) << "the hole is none of it";
  }
}

TEST(FindBag, TellsThatTheRegionCutsTheBag) {
  cv::Mat cloth = Mask();
  cloth(cv::Rect(0, 70, 173, 202)) = 255;
  EXPECT_TRUE(FindBag(cloth, kConfig)->at_border);
}

}  // namespace
}  // namespace gusset
