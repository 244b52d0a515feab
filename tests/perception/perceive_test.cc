#include "perception/perceive.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

using synthetic::Pose;

const PerceptionConfig kConfig;
const BagThresholds kBag1;

Observation Look(const RgbdFrame& frame) {
  return Perceive(frame, synthetic::Camera(), kConfig, kBag1);
}

/// The four looks of the task, the cube waiting at its place (in s3: in the mouth).
RgbdFrame FrameOf(int state, const Pose& pose = {}) {
  RgbdFrame frame = synthetic::EmptyTable();
  if (state == 0) synthetic::DrawFoldedBag(frame, pose);
  if (state == 1) synthetic::DrawFlatBag(frame, pose);
  if (state >= 2) synthetic::DrawOpenBag(frame, pose);
  synthetic::DrawCube(frame, state == 3 ? pose(0, -70) : cv::Point2d(566, 240), pose.yaw_rad);
  return frame;
}

std::vector<cv::Point2d> Pixels(const std::vector<PosePoint>& points) {
  std::vector<cv::Point2d> pixels;
  for (const PosePoint& point : points) pixels.push_back(point.px);
  return pixels;
}

void ExpectNear(const std::vector<cv::Point2d>& a, const std::vector<cv::Point2d>& b,
                double tolerance_px) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_LT(cv::norm(a[k] - b[k]), tolerance_px) << "point " << k << ": " << a[k] << b[k];
  }
}

void ExpectFinite(const Observation& o) {
  std::vector<PosePoint> points = o.grasp_points;
  points.insert(points.end(), o.place_points.begin(), o.place_points.end());
  points.insert(points.end(), o.edge_points.begin(), o.edge_points.end());
  points.push_back(o.opening_centre);
  if (o.cube) points.push_back({o.cube->px, o.cube->p_W, true});
  for (const cv::Point2d& px : o.corners) points.push_back({px});
  for (const cv::Point2d& px : o.opening_corners) points.push_back({px});
  for (const PosePoint& point : points) {
    EXPECT_TRUE(std::isfinite(point.px.x) && std::isfinite(point.px.y));
    EXPECT_TRUE(point.p_W.allFinite());
  }
  EXPECT_TRUE(std::isfinite(o.A_bag) && std::isfinite(o.A_o) && std::isfinite(o.opening_radius_px));
  if (o.rim) {
    EXPECT_NEAR(o.rim->outward_W.norm(), 1, 1e-12);
    EXPECT_NEAR(o.rim->along_W.norm(), 1, 1e-12);
  }
  EXPECT_TRUE(!o.cube || std::isfinite(o.cube->yaw_rad));
}

TEST(Perceive, TheFourTaskStatesHaveTheirPosePoints) {
  const std::size_t grasp[] = {9, 9, 0, 81};
  const std::size_t place[] = {0, 9, 9, 0};
  for (int state = 0; state < 4; ++state) {
    const Observation o = Look(FrameOf(state));
    EXPECT_EQ(static_cast<int>(o.state), state);
    EXPECT_EQ(o.grasp_points.size(), grasp[state]);
    EXPECT_EQ(o.place_points.size(), place[state]);
    EXPECT_EQ(o.edge_points.size(), state == 0 ? 9u : 0u);
    EXPECT_EQ(o.piece, state == 3);
    EXPECT_EQ(o.rim.has_value(), state != 0);
    EXPECT_TRUE(o.warnings.empty()) << o.warnings.front();
    ExpectFinite(o);
  }
}

TEST(Perceive, GraspPointsInS3KeepOffTheCube) {
  const RgbdFrame frame = FrameOf(3);
  const Observation o = Look(frame);
  ASSERT_EQ(o.grasp_points.size(), 81u);
  for (const PosePoint& point : o.grasp_points) {
    // The cube's face is 21 px wide, and a point keeps 4 px off what is no cloth.
    const cv::Point2d off = point.px - o.cube->px;
    EXPECT_GE(std::max(std::abs(off.x), std::abs(off.y)), 10.5 + kConfig.point_inset_px - 1);
  }
}

// Two rows of labels, 14 px apart: cells are a third of that, and the outer ones' centres 2.3 px
// from the row, on the lip.
TEST(Perceive, PlacePointsKeepOffTheLips) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame, {}, 0);
  synthetic::DrawCube(frame, {566, 240});
  for (const double x : {-64, -32, 0, 32, 64}) {
    synthetic::DrawLabel(frame, {}, {x, -90});
    synthetic::DrawLabel(frame, {}, {x + 1, -76});
  }
  const Observation o = Look(frame);
  ASSERT_EQ(o.state, State::kOpen);
  for (const PosePoint& point : o.place_points) {
    EXPECT_NEAR(point.px.y, 240 - 83, 7 - kConfig.label_inset_px + 1);
  }
}

TEST(Perceive, PlacePointsLieWhereTheCubeClearsTheLipsOfABentMouth) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame, {}, 0);
  synthetic::DrawCube(frame, {566, 240});
  // An L, 44 px wide: the middle of its hull lies on cloth outside the mouth.
  const std::vector<cv::Point2d> outline = {{-70, -90}, {0, -90},  {70, -90}, {70, 0},
                                            {70, 90},   {26, 90},  {26, 20},  {26, -46},
                                            {-20, -46}, {-70, -46}};
  std::vector<cv::Point2f> mouth;
  for (const cv::Point2d& p : outline) {
    synthetic::DrawLabel(frame, {}, p);
    mouth.emplace_back(static_cast<float>(320 + p.x), static_cast<float>(240 + p.y));
  }
  const Observation o = Look(frame);
  ASSERT_EQ(o.state, State::kOpen);
  ASSERT_EQ(o.place_points.size(), 9u);
  for (const PosePoint& point : o.place_points) {
    EXPECT_GE(cv::pointPolygonTest(mouth, cv::Point2f(point.px), true), kConfig.place_inset_px - 1)
        << point.px;
  }
}

TEST(Perceive, ALipRoundAFoldedCornerIsNoClosedMouth) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawBagWithFoldedCorner(frame);
  synthetic::DrawCube(frame, {566, 240});
  const Observation corner = Look(frame);
  ASSERT_EQ(corner.state, State::kOpen);
  ASSERT_TRUE(corner.width);
  EXPECT_GT(corner.width->radius_px, kConfig.place_inset_px) << "taken for a mouth it has room";
  EXPECT_FALSE(corner.width->closed);

  const Observation open = Look(FrameOf(2));
  ASSERT_TRUE(open.width);
  EXPECT_TRUE(open.width->closed);
}

TEST(Perceive, AMouthThroughWhichTableShowsIsNoClosedMouth) {
  RgbdFrame frame = FrameOf(2);
  synthetic::FillBox(frame.color, {}, {-6, -102, 12, 20}, synthetic::kCanvas);
  const Observation nicked = Look(frame);
  ASSERT_TRUE(nicked.width);
  EXPECT_TRUE(nicked.width->closed) << "5 %";
  synthetic::FillBox(frame.color, {}, {-10, -102, 20, 52}, synthetic::kCanvas);
  const Observation torn = Look(frame);
  ASSERT_TRUE(torn.width);
  EXPECT_FALSE(torn.width->closed) << "a quarter";
}

TEST(Perceive, WithoutBagItIsSuccessOrFail) {
  RgbdFrame frame = synthetic::EmptyTable();
  const Observation nothing = Look(frame);
  EXPECT_EQ(nothing.state, State::kSuccess);
  EXPECT_EQ(nothing.A_bag, 0);
  EXPECT_TRUE(nothing.grasp_points.empty());
  ExpectFinite(nothing);
  synthetic::DrawCube(frame, {566, 240});
  EXPECT_EQ(Look(frame).state, State::kSuccess);
  frame = synthetic::EmptyTable();
  synthetic::DrawCube(frame, {300, 200});
  EXPECT_EQ(Look(frame).state, State::kFail);
}

TEST(Perceive, CubeNowhereIsHiddenInAFullFrameOnly) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame);
  EXPECT_EQ(Look(frame).state, State::kFilled);
  EXPECT_TRUE(Look(frame).cube_hidden);
  EXPECT_EQ(Look(synthetic::Crop(frame)).state, State::kUnfolded);
}

TEST(Perceive, CubeOnABagWithoutMouthIsFilled) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame, {}, 0);
  synthetic::DrawCube(frame, {340, 260});
  const Observation o = Look(frame);
  EXPECT_EQ(o.state, State::kFilled);
  EXPECT_FALSE(o.cube_hidden);
  EXPECT_FALSE(o.rim);
  EXPECT_EQ(o.grasp_points.size(), 81u);
}

TEST(Perceive, CubeOnTheBodyBehindTheMouthGoesByAreas) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame);
  synthetic::DrawCube(frame, {320, 280});
  EXPECT_EQ(Look(frame).state, State::kUnfolded);
}

TEST(Perceive, CubeWithinItsWidthOfTheLabelsIsInTheMouth) {
  for (const auto& [y, state] : {std::pair{-77., State::kFilled}, {-74., State::kUnfolded}}) {
    RgbdFrame frame = synthetic::EmptyTable();
    synthetic::DrawFlatBag(frame);
    // Labels 5 px inside the rim, at y = -96; the cube is 20 px wide.
    synthetic::DrawCube(frame, Pose()(0, y));
    EXPECT_EQ(Look(frame).state, state) << y;
  }
}

// The pixels whose centres lie inside: exact up to a row along some sides, 1 % of this figure.
TEST(Perceive, FlatBagCoversItsArea) {
  for (const double yaw : {0., 0.3, 1.2}) {
    const double flat = 0.30 * 0.35 * synthetic::kPxPerMetre * synthetic::kPxPerMetre;
    EXPECT_NEAR(flat, 34950, 20);
    EXPECT_NEAR(Look(FrameOf(1, {{320, 240}, yaw})).A_bag, flat, 0.01 * flat);
  }
}

TEST(Perceive, CubeOnTheEdgeOfTheBagDoesNotNotchIt) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame);
  const double without = Look(frame).A_bag;
  // A quarter of its face over the edge: 109 px^2 more, and the soft border that is added.
  synthetic::DrawCube(frame, Pose()(synthetic::kHalfWidth - 5, 0));
  EXPECT_NEAR(Look(frame).A_bag, without + 109, 70);
}

TEST(Perceive, CubeBesideTheBagDoesNotBelongToIt) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame);
  const double without = Look(frame).A_bag;
  synthetic::DrawCube(frame, Pose()(synthetic::kHalfWidth + 12, 0));
  EXPECT_NEAR(Look(frame).A_bag, without, 20);
}

TEST(Perceive, WhiteTableBesideTheCanvasIsNoBag) {
  RgbdFrame frame = FrameOf(1);
  frame.color(cv::Rect(490, 0, 60, 480)) = synthetic::kTable;  // Up to the region's edge.
  EXPECT_NEAR(Look(frame).A_bag, Look(FrameOf(1)).A_bag, 1);
}

TEST(Perceive, ClosedMouthHasNoOpeningAndAnOpenOneIsTheUnionOverItsLabels) {
  // Five labels in a row, their centroids half a pixel off at most, over 138 px.
  EXPECT_LT(Look(FrameOf(1)).A_o, 70);
  const Observation o = Look(FrameOf(2));
  EXPECT_EQ(o.labels.size(), 10u);
  EXPECT_GT(o.A_o, 2000);
  EXPECT_LT(o.A_o, 130 * 60);
  EXPECT_NEAR(o.opening_radius_px, std::sqrt(o.A_o / std::numbers::pi), 1e-12);
  EXPECT_NEAR(o.opening_centre.px.x, 320, 6);  // The figure is symmetric, Algorithm 7 is not.
  EXPECT_NEAR(o.opening_centre.px.y, 240 - 70, 20);
}

/// The look of `state` at yaw 0 about the middle, its points turned with the bag.
std::vector<cv::Point2d> Expected(const std::vector<PosePoint>& upright, const Pose& pose) {
  std::vector<cv::Point2d> moved;
  for (const PosePoint& p : upright) moved.push_back(pose(p.px.x - 320, p.px.y - 240));
  return moved;
}

// The contour is known to a pixel, so each corner to about 1.5 and what lies between them, too.
TEST(Perceive, PointsOfS1ToS3TurnAndMoveWithTheBag) {
  for (int state = 1; state < 4; ++state) {
    const Observation upright = Look(FrameOf(state));
    for (const Pose& pose :
         {Pose{{320, 240}, std::numbers::pi / 2}, Pose{{320, 240}, std::numbers::pi},
          Pose{{320, 240}, -std::numbers::pi / 2}, Pose{{330, 225}, 0.6}, Pose{{310, 250}, -1.1},
          Pose{{305, 245}, 2.4}}) {
      const Observation o = Look(FrameOf(state, pose));
      ASSERT_EQ(o.state, upright.state);
      ExpectNear(Pixels(o.grasp_points), Expected(upright.grasp_points, pose), 2.5);
      ExpectNear(Pixels(o.place_points), Expected(upright.place_points, pose), 2.5);
    }
  }
}

TEST(Perceive, TurningTheImageKeepsTheNumbering) {
  for (int state = 1; state < 4; ++state) {
    RgbdFrame frame = synthetic::Crop(FrameOf(state, {{314, 247}, 0.23}));
    Observation before = Look(frame);
    for (int quarter = 0; quarter < 3; ++quarter) {
      RgbdFrame turned;
      cv::rotate(frame.color, turned.color, cv::ROTATE_90_CLOCKWISE);
      cv::rotate(frame.depth_mm, turned.depth_mm, cv::ROTATE_90_CLOCKWISE);
      const Observation after = Look(turned);
      ASSERT_EQ(static_cast<int>(after.state), state);
      EXPECT_EQ(after.A_bag, before.A_bag);
      // Pixels turn exactly; only ties between contour points may fall otherwise, and in s2 ties
      // between the pixels to which a place point is moved.
      for (auto member : {&Observation::grasp_points, &Observation::place_points}) {
        std::vector<cv::Point2d> expected;
        for (const PosePoint& p : before.*member) expected.emplace_back(339 - p.px.y, p.px.x);
        const bool moved = state == 2 && member == &Observation::place_points;
        ExpectNear(Pixels(after.*member), expected, moved ? 3.5 : 1.5);
      }
      frame = turned;
      before = after;
    }
  }
}

TEST(Perceive, RimDirectionsFollowTheBagInTheWorld) {
  for (const double yaw : {0., 0.7, 2.0, -2.5}) {
    const Observation o = Look(FrameOf(1, {{320, 240}, yaw}));
    ASSERT_TRUE(o.rim);
    // At yaw 0 the rim is at the top of the image: world +y. Corner 0 is at its right end. One
    // pixel in 100 is 0.6 degrees; cos of 2 degrees is 0.9994.
    EXPECT_GT(o.rim->outward_W.dot(Eigen::Vector3d(-std::sin(yaw), std::cos(yaw), 0)), 0.9994);
    EXPECT_GT(o.rim->along_W.dot(Eigen::Vector3d(-std::cos(yaw), -std::sin(yaw), 0)), 0.9994);
  }
}

// The arch of the drawn layer's labels begins beside the rim's; half way between the two ends the
// lower row of five and the two nearest it are one lip, the three deepest ones the other.
TEST(Perceive, LipsAreTheMiddlesOfTheLabelsNearTheRimAndFarFromIt) {
  for (const int state : {2, 3}) {
    for (const Pose& pose : {Pose{}, Pose{{310, 250}, -1.1}, Pose{{330, 225}, 2.4}}) {
      const Observation o = Look(FrameOf(state, pose));
      ASSERT_TRUE(o.lips);
      EXPECT_LT(cv::norm(o.lips->near.px - pose(0, -(2 * 95 + 3 * 96 + 2 * 75) / 7.0)), 3);
      EXPECT_LT(cv::norm(o.lips->drawn.px - pose(0, -(2 * 50 + 38) / 3.0)), 3);
    }
  }
  EXPECT_FALSE(Look(FrameOf(0)).lips);
}

TEST(Perceive, FoldedPointsMoveWithTheBagAndKeepTheirOrderWhenItTurns) {
  const Observation middle = Look(FrameOf(0));
  const Observation moved = Look(FrameOf(0, {{350, 215}}));
  ExpectNear(Pixels(moved.grasp_points), Expected(middle.grasp_points, {{350, 215}}), 1e-9);
  // Numbered from the upper right to the left.
  for (const double yaw : {0.0, 0.7, -2.0}) {
    const std::vector<cv::Point2d> px = Pixels(Look(FrameOf(0, {{322, 241}, yaw})).grasp_points);
    for (const int k : {0, 1, 3, 4, 6, 7}) EXPECT_GT(px[k].x, px[k + 1].x + 5) << yaw;
    for (const int k : {0, 1, 2, 3, 4, 5}) EXPECT_LT(px[k].y, px[k + 3].y - 5) << yaw;
  }
}

TEST(Perceive, EdgePointsLieJustInsideTheClothBeyondTheirFoldedPoints) {
  const PerceptionConfig config;
  for (const Pose& pose : {Pose{}, Pose{{345, 220}, 0.4}}) {
    const RgbdFrame frame = FrameOf(0, pose);
    const Observation o = Look(frame);
    ASSERT_EQ(o.edge_points.size(), 9u);
    EXPECT_EQ(o.edge_points[4].px, o.grasp_points[4].px) << "the middle has no side";
    for (const int k : {0, 1, 2, 3, 5, 6, 7, 8}) {
      const cv::Point2d point = o.grasp_points[k].px - o.bag_centroid;
      const cv::Point2d edge = o.edge_points[k].px - o.bag_centroid;
      EXPECT_GT(cv::norm(edge), cv::norm(point));
      EXPECT_GE(edge.dot(point) / (cv::norm(edge) * cv::norm(point)),
                std::cos((config.edge_cone_deg + 3) * std::numbers::pi / 180));
      // On the cloth, and beyond it one inset further out.
      const cv::Point2d out = edge / cv::norm(edge);
      const auto is_cloth = [&](const cv::Point2d& px) {
        return frame.color.at<cv::Vec3b>(cv::Point(cvRound(px.x), cvRound(px.y)))[2] == 209;
      };
      EXPECT_TRUE(is_cloth(o.edge_points[k].px));
      EXPECT_FALSE(is_cloth(o.edge_points[k].px + (config.edge_inset_px + 3) * out));
    }
  }
}

TEST(Perceive, UnfoldedPointsLieBesideTheRim) {
  const Observation o = Look(FrameOf(1));
  for (int k = 0; k < 9; ++k) {
    // 0.5/9 of the depth from the rim, spread over the width; from the right since the rim is up.
    EXPECT_NEAR(o.grasp_points[k].px.x, 320 + synthetic::kHalfWidth * (1 - (2 * k + 1) / 9.), 1.5);
    EXPECT_NEAR(o.grasp_points[k].px.y, 240 - synthetic::kHalfDepth * (1 - 1.0 / 9), 1.5);
    EXPECT_NEAR(o.place_points[k].px.y, 240 + synthetic::kHalfDepth * (k / 3 - 1) * 2 / 3, 1.5);
  }
}

TEST(Perceive, PointsLieOnTheClothAndCarryTheirDepth) {
  // A bent body: most of the quadrilateral's middle is canvas.
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawCube(frame, {566, 240});
  synthetic::FillBox(frame.color, {}, {-70, -70, 140, 40}, synthetic::kCloth);
  synthetic::FillBox(frame.color, {}, {-70, -70, 40, 140}, synthetic::kCloth);
  frame.depth_mm -= 3 * (frame.depth_mm == 0) / 255;
  const Observation o = Look(frame);
  ASSERT_EQ(o.state, State::kFolded);
  for (const PosePoint& point : o.grasp_points) {
    const cv::Point at(cvRound(point.px.x), cvRound(point.px.y));
    EXPECT_EQ(frame.color.at<cv::Vec3b>(at)[2], 209) << at;
    EXPECT_TRUE(point.from_depth);
    EXPECT_NEAR(point.p_W.z(), 0, 1e-9);
  }
}

TEST(Perceive, WithoutDepthEveryPointLiesOnTheTableAndAWarningSaysSo) {
  for (int state = 0; state < 4; ++state) {
    RgbdFrame frame = FrameOf(state);
    frame.depth_mm = cv::Mat();
    const Observation o = Look(frame);
    EXPECT_EQ(static_cast<int>(o.state), state);
    ASSERT_FALSE(o.warnings.empty());
    for (const PosePoint& point : o.grasp_points) {
      EXPECT_FALSE(point.from_depth);
      EXPECT_NEAR(point.p_W.z(), 0, 1e-12);
    }
    ExpectFinite(o);
    frame.depth_mm = cv::Mat::zeros(480, 640, CV_16UC1);
    EXPECT_FALSE(Look(frame).warnings.empty());
  }
}

TEST(Perceive, LightAndNoiseDoNotChangeWhatIsSeen) {
  for (int state = 0; state < 4; ++state) {
    const Observation calm = Look(FrameOf(state));
    for (const double gain : {0.5, 0.8, 1.2}) {
      RgbdFrame frame = FrameOf(state);
      synthetic::Light(frame, gain, 4, 11 + state);
      const Observation o = Look(frame);
      EXPECT_EQ(o.state, calm.state) << gain;
      EXPECT_EQ(o.labels.size(), calm.labels.size()) << gain;
      // Border pixels that noise tips over: a share of the 750 there are.
      EXPECT_NEAR(o.A_bag, calm.A_bag, 150) << gain;
    }
  }
}

TEST(Perceive, ShadowsAndCreasesDoNotBreakTheBag) {
  RgbdFrame frame = FrameOf(1);
  const double without = Look(frame).A_bag;
  // A dark crease right across, and a soft shadow over a third of the bag that halves its light.
  synthetic::FillBox(frame.color, {{320, 240}, 0.3}, {-90, -2, 180, 4}, synthetic::kCanvas);
  frame.color(cv::Rect(320, 150, 120, 200)) *= 0.5;
  const Observation o = Look(frame);
  EXPECT_EQ(o.state, State::kUnfolded);
  EXPECT_NEAR(o.A_bag, without, 50);
}

TEST(Perceive, OtherImageSizesGiveTheSameAreas) {
  RgbdFrame frame = FrameOf(2);
  const Observation at_home = Look(frame);
  RgbdFrame large;
  cv::resize(frame.color, large.color, {1280, 960}, 0, 0, cv::INTER_LINEAR);
  cv::resize(frame.depth_mm, large.depth_mm, {1280, 960}, 0, 0, cv::INTER_NEAREST);
  const Observation scaled = Look(large);
  EXPECT_EQ(scaled.state, at_home.state);
  EXPECT_NEAR(scaled.A_bag, at_home.A_bag, 0.02 * at_home.A_bag);
  const Observation bare = Look(synthetic::Crop(frame));
  EXPECT_EQ(bare.state, at_home.state);
  EXPECT_EQ(bare.A_bag, at_home.A_bag);
  EXPECT_LT((bare.place_points[4].p_W - at_home.place_points[4].p_W).norm(), 1e-9);
}

TEST(Perceive, NothingIsKeptBetweenFrames) {
  const RgbdFrame frame = FrameOf(2);
  const Observation first = Look(frame);
  for (int state = 0; state < 4; ++state) (void)Look(FrameOf(state));
  const Observation again = Look(frame);
  EXPECT_EQ(again.A_o, first.A_o);
  EXPECT_EQ(again.A_bag, first.A_bag);
  EXPECT_EQ(Pixels(again.place_points), Pixels(first.place_points));
  // The opening area of the frame before is not used where no label is seen.
  EXPECT_EQ(Look(FrameOf(0)).A_o, 0);
}

TEST(Perceive, OddImagesGiveAnAnswer) {
  for (const cv::Scalar& color : {cv::Scalar(0, 0, 0), cv::Scalar(255, 255, 255), synthetic::kCloth,
                                  synthetic::kLabel, synthetic::kCube}) {
    for (const cv::Size size :
         {cv::Size(640, 480), cv::Size(340, 340), cv::Size(1, 1), cv::Size(7, 500)}) {
      const Observation o = Look({cv::Mat(size, CV_8UC3, color), {}});
      EXPECT_FALSE(o.bag_seen);
      ExpectFinite(o);
    }
  }
  RgbdFrame noise = synthetic::EmptyTable();
  synthetic::Light(noise, 1, 90, 3);
  ExpectFinite(Look(noise));
}

TEST(Perceive, WrongTypesAreRefused) {
  EXPECT_THROW((void)Look({}), std::invalid_argument);
  EXPECT_THROW((void)Look({cv::Mat::zeros(480, 640, CV_16UC1), {}}), std::invalid_argument);
  EXPECT_THROW((void)Look({cv::Mat::zeros(480, 640, CV_8UC3), cv::Mat::zeros(480, 640, CV_32FC1)}),
               std::invalid_argument);
}

}  // namespace
}  // namespace gusset
