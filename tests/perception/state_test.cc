#include "perception/state.h"

#include <gtest/gtest.h>

namespace gusset {
namespace {

const BagThresholds kBag1;

/// A flat bag with its mouth seen and closed, the cube waiting beside the region of interest.
Evidence Unfolded() {
  Evidence evidence;
  evidence.has_surroundings = true;
  evidence.bag_seen = true;
  evidence.cube_seen = true;
  evidence.labels_seen = 5;
  evidence.A_bag = 34950;
  evidence.A_o = 60;
  return evidence;
}

State StateOf(const Evidence& evidence) { return ClassifyState(evidence, kBag1).state; }

TEST(State, NamesAreTheThesissIndices) {
  EXPECT_EQ(StateName(State::kFolded), "s0");
  EXPECT_EQ(StateName(State::kFail), "s5");
}

TEST(State, WithoutBagAndCubeItIsSuccess) { EXPECT_EQ(StateOf({}), State::kSuccess); }

TEST(State, WithoutBagACubeBesideTheRegionIsSuccess) {
  Evidence evidence;
  evidence.has_surroundings = true;
  evidence.cube_seen = true;
  EXPECT_EQ(StateOf(evidence), State::kSuccess);
}

TEST(State, WithoutBagACubeInTheRegionIsFail) {
  Evidence evidence;
  evidence.cube_seen = evidence.cube_in_roi = true;
  EXPECT_EQ(StateOf(evidence), State::kFail);
}

TEST(State, CubeInTheMouthIsFilledWhateverTheAreas) {
  Evidence evidence = Unfolded();
  evidence.cube_in_roi = evidence.cube_in_mouth = true;
  for (const double area : {500., 25000., 35000.}) {
    evidence.A_bag = area;
    const Classified classified = ClassifyState(evidence, kBag1);
    EXPECT_EQ(classified.state, State::kFilled);
    EXPECT_FALSE(classified.cube_hidden);
  }
}

TEST(State, CubeOnTheBagIsFilledOnlyWhileTheMouthIsNotSeen) {
  Evidence evidence = Unfolded();
  evidence.cube_in_roi = evidence.cube_on_bag = true;
  evidence.labels_seen = 2;
  EXPECT_EQ(StateOf(evidence), State::kFilled);
  evidence.labels_seen = 3;
  EXPECT_EQ(StateOf(evidence), State::kUnfolded);
}

TEST(State, CubeNowhereInAFullFrameIsHidden) {
  Evidence evidence = Unfolded();
  evidence.cube_seen = false;
  const Classified classified = ClassifyState(evidence, kBag1);
  EXPECT_EQ(classified.state, State::kFilled);
  EXPECT_TRUE(classified.cube_hidden);
}

TEST(State, CubeNowhereInABareRegionGoesByAreas) {
  Evidence evidence = Unfolded();
  evidence.has_surroundings = false;
  evidence.cube_seen = false;
  EXPECT_EQ(StateOf(evidence), State::kUnfolded);
  EXPECT_FALSE(ClassifyState(evidence, kBag1).cube_hidden);
}

TEST(State, OpenNeedsOpeningAboveItsThreshold) {
  Evidence evidence = Unfolded();
  evidence.A_o = kBag1.A_oth;
  EXPECT_EQ(StateOf(evidence), State::kUnfolded);
  evidence.A_o = kBag1.A_oth + 1;
  EXPECT_EQ(StateOf(evidence), State::kOpen);
}

TEST(State, OpenNeedsTheMouth) {
  Evidence evidence = Unfolded();
  evidence.A_o = 3000;
  evidence.labels_seen = 2;
  EXPECT_EQ(StateOf(evidence), State::kFolded);
}

TEST(State, OpenNeeds55PercentOfTheFlatBagAndNotTheFoldedThreshold) {
  Evidence evidence = Unfolded();
  evidence.A_o = 3000;
  evidence.A_bag = 0.55 * kBag1.A_flat;
  EXPECT_EQ(StateOf(evidence), State::kFolded);
  evidence.A_bag += 1;
  ASSERT_LT(evidence.A_bag, kBag1.A_th);
  EXPECT_EQ(StateOf(evidence), State::kOpen);
}

TEST(State, UpToItsThresholdTheBagIsFolded) {
  Evidence evidence = Unfolded();
  evidence.A_bag = kBag1.A_th;
  EXPECT_EQ(StateOf(evidence), State::kFolded);
  evidence.A_bag += 1;
  EXPECT_EQ(StateOf(evidence), State::kUnfolded);
}

TEST(State, ALargeBagWithoutMouthIsFolded) {
  Evidence evidence = Unfolded();
  evidence.labels_seen = 2;
  EXPECT_EQ(StateOf(evidence), State::kFolded);
}

TEST(State, FigureFiveTwoHasItsStates) {
  Evidence evidence = Unfolded();
  evidence.labels_seen = 0;
  evidence.A_bag = 9559;
  evidence.A_o = 171;
  EXPECT_EQ(StateOf(evidence), State::kFolded);
  evidence.labels_seen = 5;
  evidence.A_bag = 34946.5;
  evidence.A_o = 61;
  EXPECT_EQ(StateOf(evidence), State::kUnfolded);
  evidence.A_bag = 31527;
  evidence.A_o = 3460.5;
  EXPECT_EQ(StateOf(evidence), State::kOpen);
  evidence.A_bag = 31886.5;
  evidence.A_o = 2875.5;
  evidence.cube_in_roi = evidence.cube_in_mouth = evidence.cube_on_bag = true;
  EXPECT_EQ(StateOf(evidence), State::kFilled);
}

/// The table of docs/loop.md, row by row: the first that holds.
State ByTable(const Evidence& e, const BagThresholds& t) {
  const bool mouth = e.labels_seen >= 3;
  const bool cube_nowhere = !e.cube_seen && e.has_surroundings;
  const struct {
    bool holds;
    State state;
  } rows[] = {
      {!e.bag_seen && !e.cube_in_roi, State::kSuccess},
      {!e.bag_seen && e.cube_in_roi, State::kFail},
      {e.bag_seen && e.cube_in_roi && (e.cube_in_mouth || (e.cube_on_bag && !mouth)),
       State::kFilled},
      {e.bag_seen && cube_nowhere, State::kFilled},
      {e.bag_seen && mouth && e.A_o > t.A_oth && e.A_bag > 0.55 * t.A_flat, State::kOpen},
      {e.bag_seen && (e.A_bag <= t.A_th || !mouth), State::kFolded},
      {e.bag_seen && e.A_bag > t.A_th && mouth && e.A_o <= t.A_oth, State::kUnfolded},
  };
  for (const auto& row : rows) {
    if (row.holds) return row.state;
  }
  ADD_FAILURE() << "no row matches";
  return State::kFail;
}

TEST(State, EveryCombinationHasTheStateOfTheFirstRowThatMatches) {
  int combinations = 0;
  for (int bits = 0; bits < 64; ++bits) {
    Evidence evidence;
    evidence.has_surroundings = bits & 1;
    evidence.bag_seen = bits & 2;
    evidence.cube_seen = bits & 4;
    evidence.cube_in_roi = evidence.cube_seen && (bits & 8);
    evidence.cube_in_mouth = bits & 16;
    evidence.cube_on_bag = bits & 32;
    for (const int labels : {0, 1, 2, 3, 10}) {
      for (const double A_bag : {0., 19222., 19223., 25000., 25001., 34950.}) {
        for (const double A_o : {0., 150., 700., 701., 3900.}) {
          evidence.labels_seen = labels;
          evidence.A_bag = A_bag;
          evidence.A_o = A_o;
          EXPECT_EQ(StateOf(evidence), ByTable(evidence, kBag1));
          ++combinations;
        }
      }
    }
  }
  EXPECT_EQ(combinations, 64 * 5 * 6 * 5);
}

TEST(State, ThresholdsThatContradictEachOtherStillGiveAState) {
  BagThresholds odd;
  odd.A_th = 100;  // Below 0.55 A_flat: between them lies what no row names.
  Evidence evidence = Unfolded();
  evidence.A_bag = 5000;
  evidence.A_o = 3000;
  EXPECT_EQ(ClassifyState(evidence, odd).state, State::kUnfolded);
}

}  // namespace
}  // namespace gusset
