#include "tools/gusset/photograph.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "perception/perceive.h"
#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

// Off the axes, so that a mistake in any direction shows.
const synthetic::Pose kPose{{331, 233}, 0.4};

RgbdFrame OpenBag() {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawOpenBag(frame, kPose);
  synthetic::DrawCube(frame, {566, 240});
  return frame;
}

Observation See(const RgbdFrame& image, const PhotographOptions& options) {
  const Photograph photograph = PreparePhotograph(image, options, PerceptionConfig());
  return Perceive(photograph.frame, photograph.camera, PerceptionConfig(), BagThresholds());
}

RgbdFrame Larger(const RgbdFrame& frame, double scale) {
  RgbdFrame larger;
  cv::resize(frame.color, larger.color, {}, scale, scale, cv::INTER_LINEAR);
  cv::resize(frame.depth_mm, larger.depth_mm, {}, scale, scale, cv::INTER_NEAREST);
  return larger;
}

TEST(Photograph, AFrameOfTheTestbedStaysAsItIs) {
  const RgbdFrame frame = OpenBag();
  const Photograph photograph = PreparePhotograph(frame, {}, PerceptionConfig());
  EXPECT_EQ(photograph.frame.color.data, frame.color.data);
  ASSERT_EQ(photograph.warnings.size(), 1u) << "another camera's frames may be as large";
  EXPECT_TRUE(photograph.warnings[0].starts_with("taken for a frame of the testbed's camera"));
  const PhotographOptions known = {.px_per_m = NominalPxPerMetre()};
  EXPECT_TRUE(PreparePhotograph(frame, known, PerceptionConfig()).warnings.empty());
}

// Twice resampled edges move by a fraction of a pixel along the bag's 750 px of edge: 2 %.
TEST(Photograph, AnyScaleGivenGivesTheSameAreas) {
  const RgbdFrame frame = OpenBag();
  const Observation home = See(frame, {});
  ASSERT_EQ(home.state, State::kOpen);
  for (const double scale : {0.8, 1.7, 3.0}) {
    const Observation seen = See(Larger(frame, scale), {.px_per_m = scale * NominalPxPerMetre()});
    EXPECT_EQ(seen.state, home.state) << scale;
    EXPECT_NEAR(seen.A_bag, home.A_bag, 0.02 * home.A_bag) << scale;
    EXPECT_NEAR(seen.A_o, home.A_o, 0.03 * home.A_o) << scale;
    EXPECT_LT((seen.place_points[4].p_W - home.place_points[4].p_W).norm(), 0.003) << scale;
  }
}

TEST(Photograph, ACameraTellsTheScaleAndWhereThingsAre) {
  const RgbdFrame frame = OpenBag();
  const Observation home = See(frame, {});
  // The same camera with twice the pixels, its middle elsewhere: columns are added at the left.
  RgbdFrame image = Larger(frame, 2);
  cv::copyMakeBorder(image.color, image.color, 0, 0, 100, 0, cv::BORDER_CONSTANT);
  cv::copyMakeBorder(image.depth_mm, image.depth_mm, 0, 0, 100, 0, cv::BORDER_CONSTANT, 1066);
  const CameraModel camera = OverheadCamera({1230, 1230, 740.5, 480.5, 1380, 960}, 1.066);
  const Observation seen = See(image, {.camera = camera});
  EXPECT_EQ(seen.state, home.state);
  EXPECT_TRUE(seen.has_surroundings);
  EXPECT_NEAR(seen.A_bag, home.A_bag, 0.02 * home.A_bag);
  ASSERT_TRUE(seen.cube);
  EXPECT_LT((seen.cube->p_W - home.cube->p_W).norm(), 0.002);
  EXPECT_LT((seen.place_points[4].p_W - home.place_points[4].p_W).norm(), 0.003);
}

TEST(Photograph, ACameraOfAnotherShapeIsRefused) {
  const RgbdFrame frame = OpenBag();
  const CameraModel wide = OverheadCamera({615, 615, 319.5, 179.5, 640, 360}, 1.066);
  EXPECT_THROW(See(frame, {.camera = wide}), InputError);
  const CameraModel half = OverheadCamera({307.5, 307.5, 160, 120, 320, 240}, 1.066);
  EXPECT_NO_THROW(See(frame, {.camera = half}));
}

TEST(Photograph, ACropIsSeenAlone) {
  const RgbdFrame frame = OpenBag();
  const Observation home = See(frame, {});
  const Observation seen = See(frame, {.crop = cv::Rect(150, 70, 340, 340)});
  EXPECT_EQ(seen.A_bag, home.A_bag);
  EXPECT_FALSE(seen.has_surroundings);
  EXPECT_THROW((void)See(frame, {.crop = cv::Rect(150, 70, 340, 500)}), InputError);
  EXPECT_THROW((void)See(frame, {.crop = cv::Rect(0, 0, 0, 10)}), InputError);
}

TEST(Photograph, WhatIsGuessedIsSaid) {
  const RgbdFrame image = Larger(OpenBag(), 1.5);
  EXPECT_EQ(PreparePhotograph(image, {}, PerceptionConfig()).warnings.size(), 1u);
  EXPECT_THROW((void)See(image, {.px_per_m = 1e-3}), InputError);
  EXPECT_THROW((void)See(image, {.px_per_m = 1e9}), InputError);
}

}  // namespace
}  // namespace gusset
