#include "agents/rewards.h"

#include <gtest/gtest.h>

#include <cmath>

#include "agents/affordances.h"

namespace gusset {
namespace {

Observation Seen(State state, double A_bag = 0, double A_o = 0) {
  Observation seen;
  seen.state = state;
  seen.A_bag = A_bag;
  seen.A_o = A_o;
  return seen;
}

Observation OpenBag(double radius_px, cv::Point2d centre) {
  Observation seen = Seen(State::kOpen);
  seen.opening_centre.px = centre;
  seen.opening_radius_px = radius_px;
  return seen;
}

Observation Filled(std::optional<cv::Point2d> cube_px) {
  Observation seen = Seen(State::kFilled);
  if (cube_px) {
    seen.cube.emplace();
    seen.cube->px = *cube_px;
  }
  return seen;
}

const BagThresholds kBag1;

TEST(Rewards, UnfoldingPaysTheBagsAreaWhateverFollows) {
  for (const State after : {State::kFolded, State::kUnfolded, State::kOpen}) {
    EXPECT_DOUBLE_EQ(Reward(Seen(State::kFolded, 9000), Seen(after, 17000, 99), kBag1), 0.5);
  }
  EXPECT_EQ(Reward(Seen(State::kFolded), Seen(State::kSuccess), kBag1), 0) << "lost";
}

TEST(Rewards, OpeningPaysTheOpeningsArea) {
  EXPECT_DOUBLE_EQ(Reward(Seen(State::kUnfolded), Seen(State::kOpen, 30000, 1950), kBag1), 0.5);
  EXPECT_EQ(Reward(Seen(State::kUnfolded), Seen(State::kFolded, 20000, 0), kBag1), 0);
}

TEST(Rewards, PlacingFallsLinearlyFromTheCentreToTheRadius) {
  const Observation before = OpenBag(30, {300, 200});
  EXPECT_EQ(Reward(before, Filled({{300, 200}}), kBag1), 1);
  EXPECT_DOUBLE_EQ(Reward(before, Filled({{309, 212}}), kBag1), 0.5);  // 3-4-5: 15 px off
  EXPECT_EQ(Reward(before, Filled({{330, 200}}), kBag1), 0);
  EXPECT_EQ(Reward(before, Filled({{400, 200}}), kBag1), 0) << "never negative";
}

TEST(Rewards, PlacingPaysNothingUnlessTheCubeIsInTheBag) {
  Observation after = OpenBag(30, {300, 200});
  after.cube.emplace();
  after.cube->px = {300, 200};
  EXPECT_EQ(Reward(OpenBag(30, {300, 200}), after, kBag1), 0);
}

TEST(Rewards, AHiddenCubeCountsWhereItWasReleased) {
  EXPECT_DOUBLE_EQ(Reward(OpenBag(30, {300, 200}), Filled({}), kBag1, {315, 200}), 0.5);
}

TEST(Rewards, AnOpeningWithoutAreaPaysNothing) {
  EXPECT_EQ(Reward(OpenBag(0, {300, 200}), Filled({{300, 200}}), kBag1), 0);
}

TEST(Rewards, CarryingPaysOneForSuccessAndATenthLessThanNothingOtherwise) {
  EXPECT_EQ(Reward(Seen(State::kFilled), Seen(State::kSuccess), kBag1), 1);
  for (const State after :
       {State::kFolded, State::kUnfolded, State::kOpen, State::kFilled, State::kFail}) {
    EXPECT_EQ(Reward(Seen(State::kFilled), Seen(after, 30000, 3000), kBag1), -0.1);
  }
}

TEST(Affordances, EveryActionMeansOnePointAndOneParameter) {
  const int counts[] = {81, 81, 9, 81};
  for (int s = 0; s < kActingStates; ++s) {
    EXPECT_EQ(AffordanceOf(s).actions(), counts[s]);
    for (int a = 0; a < counts[s]; ++a) {
      const ActionChoice choice = DecodeAction(s, a);
      EXPECT_EQ(choice.point * AffordanceOf(s).parameters + choice.parameter, a);
      EXPECT_LT(choice.point, AffordanceOf(s).points);
      EXPECT_LT(choice.parameter, AffordanceOf(s).parameters);
    }
  }
}

}  // namespace
}  // namespace gusset
