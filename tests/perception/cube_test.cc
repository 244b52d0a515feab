#include "perception/cube.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

const PerceptionConfig kConfig;

std::optional<CubeBlob> Find(const RgbdFrame& frame) {
  const View view = MakeView(frame, synthetic::Camera(), kConfig);
  return FindCube(ThresholdColors(view, kConfig), view, kConfig);
}

CubeSeen Locate(const RgbdFrame& frame) {
  const View view = MakeView(frame, synthetic::Camera(), kConfig);
  return LocateCube(FindCube(ThresholdColors(view, kConfig), view, kConfig).value(),
                    ThresholdColors(view, kConfig), view, kConfig);
}

TEST(Cube, NoRedNoCube) { EXPECT_FALSE(Find(synthetic::EmptyTable())); }

// The face is 20.9 px wide: 436 px^2, a border pixel more or less on each side.
TEST(Cube, IsSeenAnywhereInTheFrame) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawCube(frame, {566, 240});
  const CubeSeen cube = Locate(frame);
  EXPECT_NEAR(cube.area_px2, 436, 42);
  EXPECT_FALSE(cube.in_roi);
  EXPECT_NEAR(cube.px.x, 566, 0.5);
  EXPECT_NEAR(cube.px.y, 240, 0.5);
}

// Half a pixel is 0.9 mm.
TEST(Cube, CentreIsHalfASideBelowItsTop) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawCube(frame, {400, 200});
  const CubeSeen cube = Locate(frame);
  EXPECT_TRUE(cube.from_depth);
  EXPECT_NEAR(cube.p_W.x(), 80. / 615 * 1.031, 9e-4);
  EXPECT_NEAR(cube.p_W.y(), 40. / 615 * 1.031, 9e-4);
  EXPECT_NEAR(cube.p_W.z(), 0.0175, 1e-9);
}

TEST(Cube, SideFacesDoNotShiftItWhereDepthTellsThemFromTheTop) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::FillBox(frame.color, {{556, 240}}, {-8, -10, 16, 20}, synthetic::kCube);
  synthetic::DrawCube(frame, {570, 240});
  EXPECT_NEAR(Locate(frame).px.x, 570, 0.5);
}

TEST(Cube, WithoutDepthItStandsOnTheTable) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawCube(frame, {400, 200});
  frame.depth_mm = cv::Mat();
  const CubeSeen cube = Locate(frame);
  EXPECT_FALSE(cube.from_depth);
  EXPECT_NEAR(cube.p_W.z(), 0.0175, 1e-9);
  EXPECT_NEAR(cube.p_W.x(), 80. / 615 * (1.066 - 0.0175), 9e-4);
}

// A face of 21 px shows an angle to about one pixel in 21: 2.7 degrees.
TEST(Cube, YawIsThatOfItsEdgesWithinAQuarterTurn) {
  for (const double yaw_deg : {-40., -20., 0., 10., 35.}) {
    RgbdFrame frame = synthetic::EmptyTable();
    synthetic::DrawCube(frame, {400, 200}, yaw_deg * std::numbers::pi / 180);
    const CubeSeen cube = Locate(frame);
    EXPECT_NEAR(cube.yaw_rad * 180 / std::numbers::pi, yaw_deg, 3) << yaw_deg;
    EXPECT_NEAR(cube.area_px2, 436, 42) << yaw_deg;
  }
}

TEST(Cube, LongOrHugeOrTinyRedThingsAreNone) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::FillBox(frame.color, {{320, 200}}, {-60, -4, 120, 8}, synthetic::kCube);
  synthetic::FillBox(frame.color, {{320, 300}}, {-40, -40, 80, 80}, synthetic::kCube);
  synthetic::FillBox(frame.color, {{200, 200}}, {-4, -4, 8, 8}, synthetic::kCube);
  EXPECT_FALSE(Find(frame));
}

TEST(Cube, KnowsWhetherClothSurroundsIt) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame);
  synthetic::DrawCube(frame, {320, 240});
  EXPECT_TRUE(Find(frame)->amid_cloth);
  RgbdFrame beside = synthetic::EmptyTable();
  synthetic::DrawFlatBag(beside);
  synthetic::DrawCube(beside, {320 + synthetic::kHalfWidth + 11, 240});
  EXPECT_FALSE(Find(beside)->amid_cloth);
}

// A third of it sticks out from under a bag: what shows is a strip of 7 x 21 px beside the bag, its
// centre 7 px from the strip's. Turned, a corner of it shows. Four millimetres are 2.4 px.
TEST(Cube, UnderAnEdgeOfClothItsCentreIsWhereItsHiddenPartIs) {
  const double edge = 320 + synthetic::kHalfWidth;
  for (const double yaw_deg : {0., 25., 45.}) {
    const double yaw = yaw_deg * std::numbers::pi / 180;
    const cv::Point2d centre(edge - 3.5, 250);
    RgbdFrame frame = synthetic::EmptyTable();
    synthetic::DrawCube(frame, centre, yaw);
    synthetic::DrawFlatBag(frame);
    const View view = MakeView(frame, synthetic::Camera(), kConfig);
    const ColorMasks masks = ThresholdColors(view, kConfig);
    const std::optional<CubeBlob> blob = FindCube(masks, view, kConfig);
    ASSERT_TRUE(blob) << yaw_deg;
    EXPECT_TRUE(blob->covered);
    const CubeSeen cube = LocateCube(*blob, masks, view, kConfig);
    EXPECT_GT(cube.px.x, edge) << "the visible part's";
    EXPECT_NEAR(cube.centre_px.x, centre.x, 2.4) << yaw_deg;
    EXPECT_NEAR(cube.centre_px.y, centre.y, 2.4) << yaw_deg;
  }
}

// Nothing could hide the rest of a cube there: its centre is that of what shows, but for the
// parallax of half a cube's height, 0.017 of 40 px.
TEST(Cube, ASmallRedThingBesideALittleClothIsWhereItIsSeen) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::FillBox(frame.color, {{320, 200}}, {-5, -5, 10, 10}, synthetic::kCube);
  synthetic::FillBox(frame.color, {{328, 200}}, {-3, -6, 6, 12}, synthetic::kCloth);
  EXPECT_TRUE(Find(frame)->covered);
  const CubeSeen cube = Locate(frame);
  EXPECT_TRUE(cube.p_W.allFinite());
  EXPECT_NEAR(cube.centre_px.x, cube.px.x, 1);
  EXPECT_NEAR(cube.centre_px.y, cube.px.y, 1);
}

// Half a cube, cut along its diagonal by the edge of the cloth: 28.6 px at the table's height, 29.6
// at the top's, and there, 0.2 m out, a side shows beside it by 3.9 px. Nothing 40 px long is one.
TEST(Cube, UnderClothAlongItsDiagonalItIsStillACube) {
  for (const int length_px : {28, 32, 40}) {
    RgbdFrame frame = synthetic::EmptyTable();
    synthetic::FillBox(frame.color, {{400, 240}}, {-40, -40, 70, 80}, synthetic::kCloth);
    const std::vector<cv::Point> shown = {
        {430, 240 - length_px / 2}, {430, 239 + length_px / 2}, {445, 240}};
    cv::fillConvexPoly(frame.color, shown, synthetic::kCube);
    const std::optional<CubeBlob> blob = Find(frame);
    EXPECT_EQ(blob.has_value(), length_px < 40) << length_px;
    if (blob) {
      EXPECT_TRUE(blob->covered);
    }
  }
}

// A whole cube that only touches the bag is measured as one that stands alone.
TEST(Cube, BesideABagItIsNotCovered) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame);
  synthetic::DrawCube(frame, {320 + synthetic::kHalfWidth + 11, 240});
  EXPECT_FALSE(Find(frame)->covered);
  // The centre is 17.5 mm below the top, so it is seen nearer to the picture's middle.
  const CubeSeen cube = Locate(frame);
  EXPECT_NEAR(cube.centre_px.x - 320, (cube.px.x - 320) * 1.031 / (1.031 + 0.0175), 0.1);
}

}  // namespace
}  // namespace gusset
