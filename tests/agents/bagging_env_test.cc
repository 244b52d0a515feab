#include "agents/bagging_env.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "agents/run_folder.h"
#include "base/error.h"
#include "tests/agents/fake_rig.h"
#include "tests/agents/table_world.h"

namespace gusset {
namespace {

using Move = FakeRig::Move;

class BaggingEnvTest : public FolderTest {
 protected:
  // Begins in `state` and performs `action`, after which the world is in `next`.
  Outcome Act(int state, int action, int next) {
    rig_.next = next;
    const Percept percept = env_.Begin(std::to_string(state), 5);
    EXPECT_EQ(percept.state, state);
    return env_.Act(action);
  }
  // Tool positions of all motions but the last, which goes to the waiting pose.
  std::vector<Eigen::Vector3d> Path() const {
    std::vector<Eigen::Vector3d> path;
    for (const Move& move : rig_.moves) {
      if (move.kind == Move::kTo || move.kind == Move::kUntilContact) {
        path.push_back(move.X_WT.translation());
      }
    }
    return path;
  }

  // The same while something is held: from the fingers' closing to their next opening.
  std::vector<Eigen::Vector3d> HeldPath() const {
    std::vector<Eigen::Vector3d> path;
    bool held = false;
    for (const Move& move : rig_.moves) {
      if (move.kind == Move::kFingers) held = move.value == 0;
      if (held && move.kind == Move::kTo) path.push_back(move.X_WT.translation());
    }
    return path;
  }

  std::vector<Move> GuardedMoves() const {
    std::vector<Move> guarded;
    for (const Move& move : rig_.moves) {
      if (move.kind == Move::kUntilContact) guarded.push_back(move);
    }
    return guarded;
  }

  std::vector<double> GuardedForces() const {
    std::vector<double> forces;
    for (const Move& move : GuardedMoves()) forces.push_back(move.value);
    return forces;
  }

  double MetresPerPixelAtMouth() const {
    const CameraModel& camera = rig_.model();
    const cv::Point2d px = env_.before().opening_centre.px;
    return (camera.OntoPlane(px + cv::Point2d(1, 0), 0) - camera.OntoPlane(px, 0)).norm();
  }

  FakeRig rig_;
  BaggingConfig config_;
  BaggingEnv env_{rig_, rig_, rig_, rig_, config_};
};

TEST_F(BaggingEnvTest, EveryStateAffordsItsOwnPairOnly) {
  EXPECT_THAT(env_.ActionCounts(), testing::ElementsAre(81, 81, 9, 81));
}

class WithoutAffordances : public BaggingEnvTest {
 protected:
  static BaggingConfig Flat() {
    BaggingConfig config;
    config.affordances = false;
    return config;
  }
  BaggingEnv flat_{rig_, rig_, rig_, rig_, Flat()};
};

TEST_F(WithoutAffordances, EveryStateOffersEveryPair) {
  EXPECT_THAT(flat_.ActionCounts(), testing::ElementsAre(252, 252, 252, 252));
}

// Every index is the action of exactly one pair, in the pairs' order.
TEST_F(WithoutAffordances, IndicesRunThroughThePairs) {
  int index = 0;
  for (int pair = 0; pair < kActingStates; ++pair) {
    for (int wanted = 0; wanted < AffordanceOf(pair).actions(); ++wanted) {
      int action = -1;
      EXPECT_EQ(PairOfAction(index++, action), pair);
      EXPECT_EQ(action, wanted);
    }
  }
  EXPECT_EQ(index, AllActions());
}

TEST_F(WithoutAffordances, APairThatDoesNotFitCostsAStepAndMovesNothing) {
  constexpr int kFirst[] = {0, 81, 162, 171};
  rig_.next = 4;
  for (int state = 0; state < kActingStates; ++state) {
    for (int pair = 0; pair < kActingStates; ++pair) {
      if (pair == state) continue;
      const Percept percept = flat_.Begin(std::to_string(state), 5);
      const double before_s = rig_.time_s();
      const Outcome outcome = flat_.Act(kFirst[pair] + 3);
      EXPECT_TRUE(rig_.moves.empty());
      EXPECT_EQ(rig_.time_s(), before_s);
      EXPECT_EQ(outcome.after, std::to_string(state));
      EXPECT_EQ(outcome.next.state, state);
      EXPECT_EQ(outcome.next.features, percept.features);
      EXPECT_FALSE(outcome.done);
      EXPECT_FALSE(outcome.true_success);
      // Paid as the same look twice: A_bag / A_bmax, A_o / A_omax, no cube placed, no carry.
      const double wanted[] = {percept.features[0], percept.features[1], 0, -0.1};
      EXPECT_EQ(outcome.reward, wanted[state]);
      EXPECT_EQ(outcome.log["pair"], pair);
    }
  }
}

TEST_F(WithoutAffordances, APairThatFitsIsTheActionThatItIsWithThem) {
  constexpr int kFirst[] = {0, 81, 162, 171};
  for (int state = 0; state < kActingStates; ++state) {
    const Outcome with = Act(state, 5, 3);
    const std::size_t moves = rig_.moves.size();
    rig_.next = 3;
    flat_.Begin(std::to_string(state), 5);
    const Outcome without = flat_.Act(kFirst[state] + 5);
    EXPECT_EQ(without.log, with.log);
    EXPECT_EQ(without.reward, with.reward);
    EXPECT_EQ(rig_.moves.size(), moves);
  }
}

TEST_F(BaggingEnvTest, StatesOfTheDrawingsAreSeenAndEndEpisodesOnlyWhenTheyShould) {
  for (int next = 0; next <= 5; ++next) {
    const Outcome outcome = Act(3, 40, next);
    EXPECT_EQ(outcome.next.state, next);
    EXPECT_EQ(outcome.done, next >= 4);
    EXPECT_EQ(outcome.success, next == 4);
    EXPECT_FALSE(outcome.log["lost"]);
    EXPECT_EQ(outcome.reward, next == 4 ? 1 : -0.1);
  }
}

TEST_F(BaggingEnvTest, ABagThatLeavesOtherwiseIsLost) {
  const Outcome outcome = Act(1, 0, 4);
  EXPECT_TRUE(outcome.done);
  EXPECT_FALSE(outcome.success);
  EXPECT_TRUE(outcome.log["lost"]);
  rig_.truth.held_clear_s = 5;
  EXPECT_FALSE(Act(1, 0, 4).true_success);
}

TEST_F(BaggingEnvTest, TrueSuccessNeedsOneSecondHeldClear) {
  rig_.truth.held_clear_s = 0.99;
  EXPECT_FALSE(Act(3, 0, 4).true_success);
  rig_.truth.held_clear_s = 1;
  EXPECT_TRUE(Act(3, 0, 4).true_success);
}

TEST_F(BaggingEnvTest, TheRefereeChangesNothingThatTheAgentIsGiven) {
  const Outcome honest = Act(1, 13, 2);
  rig_.truth = {.layers_held = 2,
                .bag_held = true,
                .cube_in_bag = true,
                .bag_area_px2 = 1,
                .opening_area_px2 = 1,
                .state = 5};
  const Outcome cheated = Act(1, 13, 2);
  EXPECT_EQ(honest.reward, cheated.reward);
  EXPECT_EQ(honest.next.state, cheated.next.state);
  EXPECT_EQ(honest.next.features, cheated.next.features);
  EXPECT_EQ(cheated.log["layers_held"], 2) << "the log is told";
}

TEST_F(BaggingEnvTest, GraspLiftLiftsToTheHeightOfItsParameterAndLaysTheBagDownLow) {
  for (int k = 0; k < 9; ++k) {
    (void)Act(0, 4 * 9 + k, 1);
    const std::vector<Eigen::Vector3d> path = HeldPath();
    double highest = 0;
    for (const Eigen::Vector3d& p : path) highest = std::max(highest, p.z());
    EXPECT_NEAR(highest, config_.grasp_lift.lift_height_m(k), 1e-12);
    EXPECT_NEAR(path.back().z(), config_.grasp_lift.release_height_m, 1e-12);
    // The arm reaches a disc of 0.25 m round the table's middle.
    for (const Eigen::Vector3d& p : path) EXPECT_LE(p.head<2>().norm(), 0.25);
  }
}

TEST_F(BaggingEnvTest, GraspLiftLaysTheBagThroughTheMiddleTowardsTheSideOfItsPoint) {
  for (const int point : {0, 2, 6, 8}) {
    (void)Act(0, point * 9 + 3, 1);
    const Eigen::Vector3d centre =
        rig_.model().OntoPlane(env_.before().bag_centroid, config_.perception.table_height_m);
    const Eigen::Vector2d out =
        (env_.before().edge_points[point].p_W - centre).head<2>().normalized();
    const std::vector<Eigen::Vector3d> path = HeldPath();
    // Up, over the middle and beyond, half way down, laid.
    EXPECT_NEAR(path[1].head<2>().dot(out), -config_.grasp_lift.trail_m, 1e-9);
    EXPECT_NEAR(path[3].head<2>().dot(out), config_.grasp_lift.lay_m, 1e-9);
    EXPECT_NEAR(path[3].z(), config_.grasp_lift.release_height_m, 1e-12);
  }
}

TEST_F(BaggingEnvTest, GraspLiftPullsToTheLeftFirstForOddParametersThenRightBackAndForth) {
  for (const int parameter : {0, 1}) {
    (void)Act(0, 0 * 9 + parameter, 0);
    // Nine strokes of four moves: up, over, half way down, laid.
    const std::vector<Eigen::Vector3d> path = HeldPath();
    ASSERT_EQ(path.size(), 36u);
    const Eigen::Vector2d along = path[3].head<2>().normalized();
    const Eigen::Vector2d left(-along.y(), along.x());
    const double first = path[7].head<2>().dot(left);
    EXPECT_GT(parameter == 1 ? first : -first, 0.15);
    EXPECT_NEAR(path[11].head<2>().dot(left), -first, 1e-9);
    EXPECT_NEAR(path[11].head<2>().dot(along), path[7].head<2>().dot(along), 1e-9);
    // Then straight back and forth.
    for (const int end : {15, 19}) EXPECT_NEAR(path[end].head<2>().dot(left), 0, 1e-9);
    EXPECT_LT(path[15].head<2>().dot(along), -0.15);
    EXPECT_NEAR(path[19].head<2>().dot(along), -path[15].head<2>().dot(along), 1e-9);
    // And along the diagonals.
    for (const int end : {23, 31}) {
      const Eigen::Vector2d way = path[end].head<2>().normalized();
      EXPECT_NEAR(std::abs(way.dot(along)), std::sqrt(0.5), 1e-9);
      EXPECT_NEAR(path[end + 4].head<2>().normalized().dot(way), -1, 1e-9);
    }
    EXPECT_NEAR(path[23].head<2>().dot(path[31].head<2>()), 0, 1e-9);
  }
}

TEST_F(BaggingEnvTest, GraspLiftStopsPullingOnceTheBagLooksUnfolded) {
  const auto strokes = [&] { return HeldPath().size() / 4; };
  const auto looks = [&] {
    return std::ranges::count(rig_.moves, Move::kWaitingPose, &Move::kind) - 1;  // less the last
  };
  (void)Act(0, 9, 1);
  EXPECT_EQ(strokes(), 1u);
  EXPECT_EQ(looks(), 1);
  for (const int pulls : {2, 7}) {
    rig_.unchanged_looks = pulls;
    (void)Act(0, 9, 1);
    EXPECT_EQ(strokes(), 1u + static_cast<std::size_t>(pulls));
    EXPECT_EQ(looks(), pulls + 1);
  }
  // A cube that it lies on and a bag that is gone are not for more pulls to mend.
  rig_.unchanged_looks = 0;
  for (const int next : {3, 4, 5}) {
    (void)Act(0, 9, next);
    EXPECT_EQ(strokes(), 1u) << next;
  }
  // Each look waits for the cloth, as the last one does.
  config_.motion.settle_s += 10;
  BaggingEnv patient(rig_, rig_, rig_, rig_, config_);
  rig_.next = 1;
  (void)patient.Begin("0", 5);
  const double later_s = patient.Act(9).sim_s - Act(0, 9, 1).sim_s;
  EXPECT_NEAR(later_s, 2 * 10, 1e-9);
  // An open mouth will do, but not what a fold leaves of one.
  (void)Act(0, 9, 2);
  EXPECT_EQ(strokes(), 1u);
  rig_.corner_folded = true;
  (void)Act(0, 9, 2);
  EXPECT_EQ(strokes(), 9u);
  rig_.corner_folded = false;
  // Nor a bag a good part of which is folded under.
  (void)Act(0, 9, 1);
  const double seen_share = env_.after().A_bag / config_.chosen_thresholds().A_flat;
  for (const double off : {-0.01, 0.01}) {
    config_.grasp_lift.flat_share = seen_share + off;
    BaggingEnv env(rig_, rig_, rig_, rig_, config_);
    (void)env.Begin("0", 5);
    (void)env.Act(9);
    EXPECT_EQ(env.after().state, State::kUnfolded);
    EXPECT_EQ(strokes(), off < 0 ? 1u : 9u);
  }
  // Without looks it is pulled four times, come what may.
  config_.grasp_lift.looks = false;
  BaggingEnv blind(rig_, rig_, rig_, rig_, config_);
  rig_.next = 1;
  (void)blind.Begin("0", 5);
  (void)blind.Act(9);
  EXPECT_EQ(strokes(), 5u);
  EXPECT_EQ(looks(), 0);
}

TEST_F(BaggingEnvTest, GraspLiftTakesWhatIsOutOfReachNearerTheBagsCentre) {
  config_.grasp_lift.reach_m = 0.06;
  BaggingEnv near(rig_, rig_, rig_, rig_, config_);
  for (const int point : {0, 3, 8}) {
    rig_.next = 1;
    (void)near.Begin("0", 5);
    (void)near.Act(point * 9);
    const Eigen::Vector3d centre =
        rig_.model().OntoPlane(near.before().bag_centroid, config_.perception.table_height_m);
    const Eigen::Vector2d grasp = Path().front().head<2>();
    const Eigen::Vector2d edge = near.before().edge_points[point].p_W.head<2>();
    ASSERT_GT(edge.norm(), 0.06);
    EXPECT_NEAR(grasp.norm(), 0.06, 1e-9);
    const Eigen::Vector2d way = edge - centre.head<2>();
    EXPECT_NEAR((grasp - centre.head<2>()).dot(way.normalized()), (grasp - centre.head<2>()).norm(),
                1e-9);
    for (const Eigen::Vector3d& p : HeldPath()) EXPECT_LE(p.head<2>().norm(), 0.06 + 1e-9);
  }
}

TEST_F(BaggingEnvTest, GraspLiftPressesHarderWhileItsPadsAreEmptyAndThenGoesOn) {
  rig_.cube_between_fingers = false;
  EXPECT_EQ(Act(0, 0, 0).log["note"], "");
  const std::vector<double> forces = GuardedForces();
  // The first grasp, then eight edges: every probe lightly but for the last, which presses harder.
  const GraspLiftConfig& config = config_.grasp_lift;
  const auto tries = static_cast<std::size_t>(1 + config.retries);
  const auto probes = static_cast<std::size_t>(config.probes);
  ASSERT_EQ(forces.size(), tries + 8 * (probes - 1 + tries));
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const std::size_t edge = k < tries ? 0 : (k - tries) % (probes - 1 + tries);
    const std::size_t harder = k < tries ? k : edge < probes ? 0 : edge - (probes - 1);
    EXPECT_NEAR(forces[k], config.contact_force_N * std::pow(config.press_factor, harder), 1e-12);
  }
}

// A layer is felt for more slowly than a fold is.
TEST_F(BaggingEnvTest, GraspLiftComesDownFasterThanOtherGuardedMoves) {
  rig_.cube_between_fingers = false;
  for (const int pair : {0, 1, 3}) {
    (void)Act(pair, 0, pair + 1);
    const double speed =
        pair == 0 ? config_.grasp_lift.touch_speed_m_s : config_.motion.guarded_speed_m_s;
    EXPECT_FALSE(GuardedMoves().empty()) << pair;
    for (const Move& move : GuardedMoves()) EXPECT_EQ(move.guarded_m_s, speed) << pair;
  }
  EXPECT_GT(config_.grasp_lift.touch_speed_m_s, config_.motion.guarded_speed_m_s);
}

TEST_F(BaggingEnvTest, GraspLiftFeelsForTheEdgeFromOutsideInwards) {
  const GraspLiftConfig& config = config_.grasp_lift;
  rig_.nothing_beyond_m = config.probe_from_m - 1.5 * config.probe_step_m;
  rig_.contact_height_m = 0.001;
  (void)Act(0, 4 * 9, 0);
  // Where the fingers closed, from the second grasp on: three times on the way in, to each side.
  std::vector<Eigen::Vector2d> closed;
  for (const Move& move : rig_.moves) {
    if (move.kind != Move::kFingers || move.value != 0) continue;
    closed.push_back(move.X_WT.translation().head<2>());
  }
  ASSERT_EQ(closed.size(), 1 + 8 * 3u);
  for (std::size_t k = 1; k < closed.size(); ++k) {
    const double probe = static_cast<double>((k - 1) % 3);
    EXPECT_NEAR(closed[k].norm(), config.probe_from_m - probe * config.probe_step_m, 1e-9);
    const std::size_t first = k - (k - 1) % 3;
    EXPECT_NEAR(closed[k].normalized().dot(closed[first].normalized()), 1, 1e-9);
  }
}

TEST_F(BaggingEnvTest, GraspLiftPullsTheEdgeOutwardsByPullWhereTheArmReaches) {
  config_.grasp_lift.pull_m = 0.05;
  config_.grasp_lift.probe_from_m = 0.10;
  BaggingEnv env(rig_, rig_, rig_, rig_, config_);
  (void)env.Begin("0", 5);
  (void)env.Act(4 * 9);
  const std::vector<Eigen::Vector3d> path = HeldPath();
  ASSERT_EQ(path.size(), 36u);
  for (std::size_t end = 7; end < path.size(); end += 4) {
    EXPECT_NEAR(path[end].head<2>().norm(), 0.15, 1e-9);
  }
}

TEST_F(BaggingEnvTest, GraspLiftBeginsAboveTheEdgeAtItsPoint) {
  for (const int point : {0, 5, 8}) {
    (void)Act(0, point * 9, 1);
    const Eigen::Vector3d edge = env_.before().edge_points[point].p_W;
    EXPECT_NEAR((Path().front() - edge).head<2>().norm(), 0, 1e-12);
    EXPECT_GE(Path().front().z(), config_.motion.approach_m);
  }
}

TEST_F(BaggingEnvTest, ScratchDragTakesTheLayerFromThePointTowardsTheTarget) {
  rig_.contact_height_m = 0.003;
  // Farther than a layer is drawn, and nearer.
  for (const auto& [point, to] : {std::pair(2, 7), std::pair(4, 1)}) {
    (void)Act(1, point * 9 + to, 2);
    const Eigen::Vector3d grasp = env_.before().grasp_points[point].p_W;
    const Eigen::Vector3d target = env_.before().place_points[to].p_W;
    const std::vector<Eigen::Vector3d> path = Path();
    EXPECT_NEAR((path.front() - grasp).head<2>().norm(), 0, 1e-12);
    // Straight towards the target, as far as a layer is drawn.
    const Eigen::Vector2d asked = (target - grasp).head<2>();
    const Eigen::Vector2d dragged = (path.back() - grasp).head<2>();
    EXPECT_NEAR(dragged.norm(), config_.scratch_drag.drag_m, 1e-12);
    EXPECT_NEAR(dragged.normalized().dot(asked.normalized()), 1, 1e-12);
    // No deeper than the touch before the fingers close.
    for (const Eigen::Vector3d& p : HeldPath()) EXPECT_GE(p.z(), 0.003);
    // The fingers close along the rim.
    const Eigen::Vector3d closing = rig_.moves[1].X_WT.linear().col(0);
    EXPECT_NEAR(std::abs(closing.dot(env_.before().rim->along_W)), 1, 1e-9);
  }
}

// Where the fingers closed, and the way that they then went, for so much cloth between them.
TEST_F(BaggingEnvTest, ScratchMovesAsideAlongTheRimFromMoreClothThanOneLayersAndFromNone) {
  const ScratchDragConfig& config = config_.scratch_drag;
  for (const int action : {2 * 9 + 7, 6 * 9 + 6}) {
    std::vector<Eigen::Vector2d> drags;
    for (const double cloth_m : {config.stack_m - 1e-6, config.stack_m + 1e-6, 0.0}) {
      rig_.cloth_between_fingers_m = cloth_m;
      (void)Act(1, action, 2);
      std::vector<Eigen::Vector2d> closed;
      const int tries = cloth_m == 0 ? 1 + config.retries : 1;  // at one place
      int closings = 0;
      for (const Move& move : rig_.moves) {
        if (move.kind != Move::kFingers || move.value != 0) continue;
        if (closings++ % tries == 0) closed.push_back(move.X_WT.translation().head<2>());
      }
      const bool one_layer = cloth_m > 0 && cloth_m <= config.stack_m;
      const auto moved = static_cast<std::size_t>(one_layer ? 0 : config.asides);
      ASSERT_EQ(closings, tries * static_cast<int>(1 + moved));
      ASSERT_EQ(closed.size(), 1 + moved);
      EXPECT_NEAR((closed[0] - env_.before().grasp_points[action / 9].p_W.head<2>()).norm(), 0,
                  1e-12);
      drags.push_back(Path().back().head<2>() - closed.back());
      for (std::size_t k = 0; k < moved; ++k) {
        const Eigen::Vector2d step = closed[k + 1] - closed[k];
        EXPECT_NEAR(std::abs(step.dot(env_.before().rim->along_W.head<2>())), config.aside_m,
                    1e-12);
        EXPECT_NEAR(step.norm(), config.aside_m, 1e-12);
        EXPECT_GE(step.dot(drags[0]), 0) << "the way that the drag goes";
      }
    }
    for (const Eigen::Vector2d& drag : drags) {
      EXPECT_NEAR((drags[0] - drag).norm(), 0, 1e-12) << "dragged as far and in that direction";
    }
  }
}

TEST_F(BaggingEnvTest, ScratchPressesFirmlyAtLastWhereNothingWasCaught) {
  const ScratchDragConfig& config = config_.scratch_drag;
  for (const double cloth_m : {0.0, config.stack_m + 1e-6}) {
    rig_.cloth_between_fingers_m = cloth_m;
    (void)Act(1, 2 * 9 + 7, 2);
    const std::vector<double> forces = GuardedForces();
    std::vector<double> expected;
    for (int place = 0; place <= config.asides; ++place) {
      const bool firm = cloth_m == 0 && place == config.asides;
      for (int retry = 0; retry <= (cloth_m == 0 ? config.retries : 0); ++retry) {
        expected.push_back((firm ? config.firm_force_N : config.touch_force_N) *
                           std::pow(config.press_factor, retry));
      }
    }
    ASSERT_EQ(forces.size(), expected.size());
    for (std::size_t k = 0; k < forces.size(); ++k) EXPECT_NEAR(forces[k], expected[k], 1e-12) << k;
  }
}

// Near its base the arm has to tilt the tool. One finger would then reach the table first, and the
// other hang over the cloth: a bag there was scratched in vain, 15 times.
TEST_F(BaggingEnvTest, FingersReachTheClothTogetherWhereTheToolIsTilted) {
  rig_.tilt_rad = 0.26;
  for (const int point : {0, 8}) {
    (void)Act(1, point * 9 + 7, 2);
    // What they would rise by, closing along the rim.
    const Eigen::Vector3d p = env_.before().grasp_points[point].p_W;
    const Eigen::Vector3d out(p.x() - config_.motion.base_x_m, p.y() - config_.motion.base_y_m, 0);
    ASSERT_GT(std::sin(rig_.tilt_rad) * std::abs(out.normalized().dot(env_.before().rim->along_W)),
              0.04);
    EXPECT_FALSE(GuardedMoves().empty());
    for (const Move& move : GuardedMoves()) {
      EXPECT_NEAR(move.X_WT.linear()(2, 0), 0, 1e-9) << point;
      EXPECT_LT(std::abs(move.X_WT.linear()(2, 2)), 0.99) << "the tool is tilted";
    }
  }
}

TEST_F(BaggingEnvTest, FingersThatCannotBeTurnedLevelScratchAsTheyAre) {
  rig_.tilt_rad = 0.26;
  rig_.refuse_at = 1;  // the turn
  EXPECT_EQ(Act(1, 7, 2).log["note"], "");
  EXPECT_NEAR(Path().back().z(), config_.motion.approach_m, 1e-12) << "dragged to the end";
}

TEST_F(BaggingEnvTest, PickPlaceTakesTheCubeWhereItIsSeenToThePlacePoint) {
  (void)Act(2, 5, 3);
  const std::vector<Eigen::Vector3d> path = Path();
  EXPECT_NEAR((path.front() - env_.before().cube->p_W).head<2>().norm(), 0, 1e-12);
  EXPECT_NEAR((path.back() - env_.before().place_points[5].p_W).head<2>().norm(), 0, 1e-12);
}

TEST_F(BaggingEnvTest, ACubeBesideTheBagIsSetAsideBeforeTheBagIsMoved) {
  config_.pick_place.room_m = 1;  // every mouth is narrow
  const Eigen::Vector2d aside(config_.pick_place.aside_m.data());
  for (const int state : {0, 1, 2}) {
    for (const cv::Point2d px : {cv::Point2d(430, 300), cv::Point2d(562, 240)}) {
      rig_.cube_beside_px = px;
      BaggingEnv env(rig_, rig_, rig_, rig_, config_);
      ASSERT_EQ(env.Begin(std::to_string(state), 5).state, state);
      const Outcome outcome = env.Act(4);
      const bool in_the_way = px.x < 500;
      EXPECT_EQ(std::string(outcome.log["note"]).starts_with("cube set aside"), in_the_way);
      const std::vector<Eigen::Vector3d> path = Path();
      EXPECT_GT(path.size(), 6u) << "nothing else was done in s" << state;
      const Eigen::Vector2d cube = env.before().cube->p_W.head<2>();
      EXPECT_EQ((path.front().head<2>() - cube).norm() < 1e-9, in_the_way);
      if (!in_the_way) continue;
      const std::vector<Eigen::Vector3d> held = HeldPath();
      ASSERT_GE(held.size(), 2u);
      EXPECT_NEAR((held[1].head<2>() - aside).norm(), 0, 1e-9);
      EXPECT_GT(held[1].z(), 0.1) << "dragged through the bag";
    }
  }
}

TEST_F(BaggingEnvTest, ACubeBesideTheMouthIsSetAsideInsteadOfCarryingTheBagWithoutIt) {
  // Before the rim, and in the mouth.
  for (const cv::Point2d px :
       {cv::Point2d(270, 126), cv::Point2d(330, 126), cv::Point2d(320, 170)}) {
    rig_.cube_in_mouth_px = px;
    const Outcome outcome = Act(3, 40, 3);
    const bool in_mouth = px.y > 160;
    EXPECT_EQ(env_.before().cube->on_bag, in_mouth);
    EXPECT_EQ(outcome.log["note"], in_mouth ? "" : "cube set aside");
    if (in_mouth) continue;
    // The fingers come down on either side of the way from the bag to the cube.
    const auto closed = std::ranges::find_if(rig_.moves, [](const Move& move) {
      return move.kind == Move::kFingers && move.value == 0;
    });
    ASSERT_TRUE(closed != rig_.moves.end());
    const Eigen::Vector3d from_bag =
        env_.before().cube->p_W - rig_.model().OntoPlane(env_.before().bag_centroid, 0);
    EXPECT_LT(std::abs(closed->X_WT.linear().col(0).head<2>().dot(from_bag.head<2>().normalized())),
              std::sqrt(0.5));
  }
}

TEST_F(BaggingEnvTest, ACubeThatCannotBeSetAsideIsLeftAndTheActionGoesOn) {
  rig_.cube_beside_px = {430, 300};
  rig_.cube_between_fingers = false;
  rig_.cube_in_mouth_px = {330, 126};
  const std::string carried = Act(3, 40, 3).log["note"];
  EXPECT_TRUE(carried.starts_with("cube not set aside: pick: nothing between the fingers"));
  EXPECT_GT(Path().size(), 6u) << "the bag was left, too";
  const Outcome outcome = Act(0, 4, 0);
  EXPECT_EQ(outcome.log["note"], "cube not set aside: pick: nothing between the fingers");
  const Eigen::Vector2d edge = env_.before().edge_points[0].p_W.head<2>();
  EXPECT_TRUE(std::ranges::any_of(
      Path(), [&](const Eigen::Vector3d& p) { return (p.head<2>() - edge).norm() < 1e-9; }));
}

TEST_F(BaggingEnvTest, PickPlaceSlidesTheCubeInFromTheNearLip) {
  for (const int point : {0, 4, 8}) {
    (void)Act(2, point, 3);
    const Lips& lips = *env_.before().lips;
    const Eigen::Vector2d outward = (lips.near.p_W - lips.drawn.p_W).head<2>().normalized();
    const Eigen::Vector2d place = env_.before().place_points[point].p_W.head<2>();
    const Move* slide = nullptr;
    const Move* before = nullptr;
    double picked_z = 0;
    for (std::size_t i = 1; i < rig_.moves.size(); ++i) {
      const Move& move = rig_.moves[i];
      if (move.kind == Move::kFingers && move.value == 0) picked_z = move.X_WT.translation().z();
      if (move.kind != Move::kUntilContact) continue;
      slide = &rig_.moves[i];
      before = &rig_.moves[i - 1];
    }
    ASSERT_NE(slide, nullptr);
    EXPECT_EQ(slide->value, config_.pick_place.slide_force_N);
    for (const Move* move : {before, slide}) {
      EXPECT_NEAR(move->X_WT.translation().z() - picked_z, config_.pick_place.slide_height_m,
                  1e-12);
    }
    const Eigen::Vector2d down = before->X_WT.translation().head<2>();
    const double inset = (lips.near.p_W.head<2>() - down).dot(outward);
    // Not beyond the lip; straight inwards; the fingers beside the cube, not before it.
    EXPECT_GE(inset, std::min(config_.pick_place.lip_inset_m,
                              (lips.near.p_W.head<2>() - place).dot(outward)) -
                         1e-9);
    EXPECT_NEAR((down - place).norm(), (down - place).dot(outward), 1e-9);
    EXPECT_NEAR(slide->X_WT.linear().col(0).head<2>().dot(outward), 0, 1e-9);
  }
}

TEST_F(BaggingEnvTest, PickPlaceWidensANarrowMouthAndLeavesTheCubeWhereItIs) {
  (void)env_.Begin("2", 5);
  const double radius_m = env_.before().width->radius_px * MetresPerPixelAtMouth();
  config_.pick_place.slit_m = 0;
  for (const double room : {0.99 * radius_m, 1.01 * radius_m}) {
    config_.pick_place.room_m = room;
    BaggingEnv env(rig_, rig_, rig_, rig_, config_);
    (void)env.Begin("2", 5);
    const bool widened = env.Act(5).log["note"] == "mouth widened";
    EXPECT_EQ(widened, room > radius_m);
    double nearest = 1;
    for (const Eigen::Vector3d& p : Path()) {
      nearest = std::min(nearest, (p - env.before().cube->p_W).head<2>().norm());
    }
    EXPECT_EQ(nearest > 0.1, widened);
  }
}

TEST_F(BaggingEnvTest, PickPlaceLaysABagWithAShortNarrowMouthFlatByItsNearLip) {
  (void)env_.Begin("2", 5);
  const double length_m = env_.before().width->length_px * MetresPerPixelAtMouth();
  config_.pick_place.room_m = 0.1;
  for (const double slit : {0.99 * length_m, 1.01 * length_m}) {
    config_.pick_place.slit_m = slit;
    BaggingEnv env(rig_, rig_, rig_, rig_, config_);
    (void)env.Begin("2", 5);
    const bool laid_flat = env.Act(5).log["note"] == "bag laid flat";
    EXPECT_EQ(laid_flat, slit > length_m);
    const Eigen::Vector2d near = env.before().lips->near.p_W.head<2>();
    const double aside = (HeldPath().front().head<2>() - near).norm();
    if (laid_flat) {
      EXPECT_NEAR(aside, config_.pick_place.grasp_inset_m, 1e-9);
    }
    double highest = 0;
    for (const Eigen::Vector3d& p : HeldPath()) highest = std::max(highest, p.z());
    EXPECT_EQ(highest >= config_.grasp_lift.lift_low_m, laid_flat);
  }
}

TEST_F(BaggingEnvTest, PickPlaceLaysABagFlatWhoseLabelsDoNotGoRoundAMouth) {
  config_.pick_place.slit_m = 0;
  config_.pick_place.room_m = 0.017;
  BaggingEnv env(rig_, rig_, rig_, rig_, config_);
  for (const bool folded : {false, true}) {
    rig_.corner_folded = folded;
    (void)env.Begin("2", 5);
    ASSERT_GT(env.before().width->radius_px, 0.018 * synthetic::kPxPerMetre);
    EXPECT_EQ(env.Act(5).log["note"] == "bag laid flat", folded);
  }
}

TEST_F(BaggingEnvTest, PickPlaceLooksAfterItHasMendedTheMouthAndPlacesIfThereIsRoom) {
  config_.pick_place.room_m = 0.017;
  BaggingEnv env(rig_, rig_, rig_, rig_, config_);
  (void)env.Begin("2", 5);
  const Observation healed = env.before();
  for (const bool heals : {true, false}) {
    rig_.corner_folded = true;
    rig_.corner_unfolds = heals;
    // Once in laying it flat, once after that: filled when the arm leaves for the third time.
    rig_.unchanged_looks = heals ? 2 : 100;
    rig_.next = 3;
    (void)env.Begin("2", 5);
    const int mends = heals ? 1 : config_.pick_place.mends;
    std::string note;
    for (int k = 0; k < mends; ++k) note += std::string(k > 0 ? "; " : "") + "bag laid flat";
    const Outcome outcome = env.Act(5);
    EXPECT_EQ(outcome.log["note"], note + (heals ? "; then placed" : ""));
    EXPECT_EQ(outcome.next.state, heals ? 3 : 2);
    if (!heals) {
      EXPECT_EQ(outcome.reward, 0);
      continue;
    }
    // Where the look after the mending has the place point, and paid for that mouth.
    const Eigen::Vector3d place_W = healed.place_points[5].p_W;
    EXPECT_NEAR((Path().back() - place_W).head<2>().norm(), 0, 1e-9);
    EXPECT_EQ(outcome.log["point_m"][0], place_W.x());
    const auto paid = [&](const Observation& mouth) {
      const double off = cv::norm(env.after().cube->px - mouth.opening_centre.px);
      return std::max(0.0, 1 - off / mouth.opening_radius_px);
    };
    ASSERT_GT(std::abs(paid(healed) - paid(env.before())), 0.01);
    EXPECT_NEAR(outcome.reward, paid(healed), 1e-9);
  }
}

TEST_F(BaggingEnvTest, PickPlaceDrawsTheInnerSideOfANarrowMouthAwayFromTheOther) {
  config_.pick_place.room_m = 0.1;
  config_.pick_place.slit_m = 0;
  (void)env_.Begin("2", 5);
  const Eigen::Vector2d outward = env_.before().rim->outward_W.head<2>();
  Eigen::Vector2d inner = env_.before().width->sides[0].p_W.head<2>();
  Eigen::Vector2d outer = env_.before().width->sides[1].p_W.head<2>();
  if (inner.dot(outward) > outer.dot(outward)) std::swap(inner, outer);
  const Eigen::Vector2d way = (inner - outer).normalized();
  const double apart = (inner - outer).norm();
  const double off_deg = std::acos(-way.dot(outward)) * 180 / std::numbers::pi;
  config_.pick_place.widen_m = 0.5 * apart;
  struct Case {
    double back_deg, opening, lift_m, drawn;  // opening and drawn as multiples of apart
  };
  // As far as an opening if that is the way back from the rim, of which a lip beyond halfway has
  // gone a part.
  for (const Case& c : {Case{off_deg - 0.1, 1.9, 0.03, 0.5}, Case{off_deg + 0.1, 1.9, 0.03, 0.9},
                        Case{off_deg + 0.1, 2.1, 0.05, 2.1}, Case{off_deg - 0.1, 2.1, 0.05, 0.5},
                        Case{off_deg + 0.1, 1.4, 0.03, 0.5}}) {
    config_.pick_place.back_deg = c.back_deg;
    config_.pick_place.widen_lift_m = c.lift_m;
    config_.scratch_drag.drag_m = c.opening * apart;
    BaggingEnv env(rig_, rig_, rig_, rig_, config_);
    rig_.moves.clear();
    (void)env.Begin("2", 5);
    ASSERT_EQ(env.Act(5).log["note"], "mouth widened");
    const std::vector<Eigen::Vector3d> path = HeldPath();
    const Eigen::Vector2d grasp = inner + config_.pick_place.grasp_inset_m * way;
    EXPECT_NEAR((path.front().head<2>() - grasp).norm(), 0, 1e-9);
    EXPECT_NEAR((path.back().head<2>() - (grasp + c.drawn * apart * way)).norm(), 0, 1e-9);
    double touched = 1, highest = 0;
    for (const Move& move : rig_.moves) {
      if (move.kind == Move::kUntilContact) touched = move.X_WT.translation().z();
    }
    for (const Eigen::Vector3d& p : path) highest = std::max(highest, p.z());
    EXPECT_NEAR(highest - touched, c.lift_m, 1e-9);
  }
}

TEST_F(BaggingEnvTest, NothingBetweenTheFingersIsNotCarried) {
  rig_.cube_between_fingers = false;
  const Outcome outcome = Act(2, 5, 2);
  EXPECT_EQ(outcome.log["note"], "pick: nothing between the fingers");
  for (const Eigen::Vector3d& p : Path()) {
    EXPECT_NEAR((p - env_.before().cube->p_W).head<2>().norm(), 0, 1e-12);
  }
}

TEST_F(BaggingEnvTest, CloseCarryKeepsHoldOfTheBag) {
  (void)Act(3, 40, 4);
  double fingers = 1;
  for (const Move& move : rig_.moves) {
    if (move.kind == Move::kFingers) fingers = move.value;
  }
  EXPECT_EQ(fingers, 0);
  EXPECT_EQ(rig_.moves.back().kind, Move::kWaitingPose);
}

TEST_F(BaggingEnvTest, CloseCarryLaysABagThatIsTooLightDownAgainAwayFromTheCube) {
  const double filled_N = config_.close_carry.filled_N;
  for (const double weight_N : {1.01 * filled_N, 0.99 * filled_N}) {
    for (const cv::Point2d& cube_px : {cv::Point2d(300, 160), cv::Point2d(345, 180)}) {
      rig_.weight_N = weight_N;
      rig_.cube_in_mouth_px = cube_px;
      const Outcome outcome = Act(3, 40, 3);
      const auto first_home = std::find_if(rig_.moves.begin(), rig_.moves.end(), [](const Move& m) {
        return m.kind == Move::kWaitingPose;
      });
      const auto opened = std::find_if(first_home, rig_.moves.end(), [](const Move& m) {
        return m.kind == Move::kFingers && m.value > 0;
      });
      EXPECT_EQ(rig_.moves.back().kind, Move::kWaitingPose);
      if (weight_N > filled_N) {
        EXPECT_EQ(outcome.log["note"], "");
        EXPECT_TRUE(opened == rig_.moves.end()) << "let go of what it should carry";
        continue;
      }
      EXPECT_EQ(outcome.log["note"], "too light: laid down again");
      ASSERT_TRUE(opened != rig_.moves.end());
      const Eigen::Vector3d laid = opened->X_WT.translation();
      const Eigen::Vector2d cube = env_.before().cube->p_W.head<2>();
      EXPECT_LT(laid.head<2>().normalized().dot(cube.normalized()), -0.999);
      EXPECT_LE(laid.head<2>().norm(), 0.25) << "beyond the arm's reach";
      EXPECT_LE(laid.z(), 0.02);
    }
  }
}

TEST_F(BaggingEnvTest, CloseCarryClosesAtTheTableAndLiftsWhereTheArmReaches) {
  for (const int point : {0, 40, 80}) {
    (void)Act(3, point, 4);
    const std::vector<Eigen::Vector3d> path = HeldPath();
    ASSERT_GE(path.size(), 2u);
    EXPECT_NEAR(path.end()[-2].z(), config_.close_carry.upright_m, 1e-12);
    EXPECT_LE(path.back().head<2>().norm(), config_.close_carry.column_m + 1e-9);
    EXPECT_NEAR(path.back().z(), config_.close_carry.lift_height_m, 1e-12);
  }
}

TEST_F(BaggingEnvTest, CloseCarryFirstDrawsTheLipsTogetherIfTheyAreApart) {
  (void)Act(3, 4, 4);
  const Lips& lips = *env_.before().lips;
  const Eigen::Vector2d apart = (lips.near.p_W - lips.drawn.p_W).head<2>();
  ASSERT_GT(apart.norm(), config_.close_carry.lips_apart_m);
  const std::vector<Eigen::Vector3d> path = HeldPath();
  ASSERT_EQ(path.size(), 5u) << "three moves with the lip, two with the bag";
  // To where the bag is grasped, and pressed down there: no move between, the lip would spring
  // back.
  const Eigen::Vector2d pressed = path[2].head<2>();
  EXPECT_GT((pressed - path[0].head<2>()).dot(apart.normalized()), 0.5 * apart.norm());
  EXPECT_NEAR((pressed - path[3].head<2>()).norm(), 0, 1e-12);
  // Pads 22 mm wide (2F-85 manual), closing along the lip, do not seize what lies before it.
  const Eigen::Vector2d grasped = path[0].head<2>();
  const double behind = (lips.drawn.p_W.head<2>() - grasped).dot(apart.normalized());
  EXPECT_GE(behind, 0.011);
}

TEST_F(BaggingEnvTest, CloseCarryLetsALimpLipFallFromAboveTheCubeAndLooks) {
  const double release_m = config_.close_carry.lip_release_m = 0.05;
  BaggingEnv env(rig_, rig_, rig_, rig_, config_);
  for (const bool carried : {true, false}) {
    // The drawn bag's lips stay apart: dropped as often as may be, then it is carried. Not if the
    // cube is not seen in the mouth any more.
    rig_.next = carried ? 3 : 2;
    ASSERT_EQ(env.Begin("3", 5).state, 3);
    (void)env.Act(4);
    int looks = 0, closings = 0;
    std::vector<Eigen::Vector3d> let_go;
    bool held = false;
    for (const Move& move : rig_.moves) {
      looks += move.kind == Move::kWaitingPose;
      if (move.kind != Move::kFingers) continue;
      closings += move.value == 0;
      if (held && move.value > 0) let_go.push_back(move.X_WT.translation());
      held = move.value == 0;
    }
    const int drops = carried ? config_.close_carry.lip_drops : 1;
    EXPECT_EQ(closings, drops + (carried ? 1 : 0));
    EXPECT_EQ(held, carried);
    // The look at the action's end is another; a carried bag is weighed there first.
    EXPECT_EQ(looks, drops + (carried ? 2 : 1));
    ASSERT_EQ(let_go.size(), static_cast<std::size_t>(drops));
    const Eigen::Vector2d near = env.before().lips->near.p_W.head<2>();
    for (const Eigen::Vector3d& p : let_go) {
      EXPECT_NEAR(p.z(), release_m, 1e-12);
      EXPECT_LT((p.head<2>() - near).norm(), 1.01 * config_.close_carry.rim_aside_m);
    }
  }
}

TEST_F(BaggingEnvTest, CloseCarryGraspsCloseToTheMiddleOfTheNearLip) {
  const double inset = config_.close_carry.rim_inset_m = 0.02;
  const double aside = config_.close_carry.rim_aside_m;
  const Mouth mouth{{0, -0.1, 0}, {0, -0.09, 0}};  // outward is -y
  const auto grasp = [&](const Eigen::Vector3d& p_W, const std::optional<Mouth>& seen) {
    rig_.moves.clear();
    ToolMotion tool(rig_, config_.motion);
    CloseCarry(tool, p_W, {1, 0, 0}, seen, p_W, config_.close_carry, config_.scratch_drag,
               config_.grasp_lift, config_.motion);
    return Eigen::Vector2d(HeldPath().front().head<2>());
  };
  const Eigen::Vector3d deep(aside, 0.1, 0);
  const Eigen::Vector3d shallow(-0.02, -0.1 + 0.5 * inset, 0);
  EXPECT_TRUE(grasp(deep, mouth).isApprox(Eigen::Vector2d(aside, -0.1 + inset), 1e-12));
  for (const double side : {-1, 1}) {
    const Eigen::Vector3d corner(side * 3 * aside, -0.1 + 0.5 * inset, 0);
    EXPECT_TRUE(grasp(corner, mouth).isApprox(Eigen::Vector2d(side * aside, corner.y()), 1e-12));
  }
  EXPECT_TRUE(grasp(shallow, mouth).isApprox(Eigen::Vector2d(shallow.head<2>()), 1e-12));
  EXPECT_TRUE(grasp(deep, std::nullopt).isApprox(Eigen::Vector2d(deep.head<2>()), 1e-12));
}

TEST_F(BaggingEnvTest, CloseCarryTakesWhatIsOutOfReachNearerTheCube) {
  const double reach = config_.grasp_lift.reach_m;
  const Eigen::Vector3d cube_W(0.05, -0.1, 0);
  for (const double beyond_m : {-0.01, 0.03}) {
    const Eigen::Vector3d p_W(0, -reach - beyond_m, 0);
    rig_.moves.clear();
    ToolMotion tool(rig_, config_.motion);
    CloseCarry(tool, p_W, {1, 0, 0}, std::nullopt, cube_W, config_.close_carry,
               config_.scratch_drag, config_.grasp_lift, config_.motion);
    const Eigen::Vector3d grasp = At(HeldPath().front(), 0);
    if (beyond_m < 0) {
      EXPECT_TRUE(grasp.isApprox(p_W, 1e-12));
    } else {
      EXPECT_NEAR(grasp.norm(), reach, 1e-9);
      EXPECT_NEAR((grasp - cube_W).cross(p_W - cube_W).norm(), 0, 1e-9)
          << "off the way to the cube";
    }
  }
  // A lip that is to fall is let go of there, too.
  config_.close_carry.lip_release_m = 0.05;
  const Mouth mouth{{0, -reach - 0.02, 0}, {0, -reach + 0.06, 0}};
  rig_.moves.clear();
  ToolMotion tool(rig_, config_.motion);
  DropLip(tool, mouth.near_W, {1, 0, 0}, mouth, cube_W, config_.close_carry, config_.scratch_drag,
          config_.grasp_lift, config_.motion);
  EXPECT_NEAR(At(HeldPath().back(), 0).norm(), reach, 1e-9);
}

// Where the fingers meet on nothing the same grasp would fail again, in this action and the next.
TEST_F(BaggingEnvTest, CloseCarryGraspsNearerTheCubeWhereItsPadsAreEmpty) {
  CloseCarryConfig& config = config_.close_carry;
  const double step = config.retry_step_m;
  // How far behind the first grasp the fingers closed, towards the cube at `cube_m`. The rig's find
  // something from `cloth_m` on.
  const auto closed = [&](double cube_m, double cloth_m) {
    const Eigen::Vector3d p_W(0, -0.2, 0);
    rig_.nothing_beyond_m = 0.2 + 1e-9 - cloth_m;
    rig_.moves.clear();
    ToolMotion tool(rig_, config_.motion);
    CloseCarry(tool, p_W, {1, 0, 0}, std::nullopt, p_W + Eigen::Vector3d(0, cube_m, 0), config,
               config_.scratch_drag, config_.grasp_lift, config_.motion);
    std::vector<double> behind;
    for (const Move& move : rig_.moves) {
      if (move.kind != Move::kFingers || move.value > 0) continue;
      const Eigen::Vector3d at_W = move.X_WT.translation();
      EXPECT_NEAR((at_W - Eigen::Vector3d(0, at_W.y(), config.height_m)).norm(), 0, 1e-12);
      behind.push_back(at_W.y() - p_W.y());
    }
    EXPECT_EQ(tool.note(), behind.size() > 1 ? "closed anew" : "");
    // The last is carried to be weighed, whatever the fingers felt.
    EXPECT_EQ(std::ranges::count(rig_.moves, Move::kWaitingPose, &Move::kind), 1);
    return behind;
  };
  using testing::DoubleNear;
  using testing::ElementsAre;
  const auto at = [](double m) { return DoubleNear(m, 1e-9); };
  ASSERT_EQ(config.retries, 3);
  EXPECT_THAT(closed(0.15, 0), ElementsAre(at(0)));
  EXPECT_THAT(closed(0.15, step), ElementsAre(at(0), at(step)));
  EXPECT_THAT(closed(0.15, 1), ElementsAre(at(0), at(step), at(2 * step), at(3 * step)));
  // Not on the cube, 35 mm wide, with pads of 22 mm; and no place twice.
  const std::vector<double> beside = closed(0.0285 + 1.5 * step, 1);
  EXPECT_THAT(beside, ElementsAre(at(0), at(step), testing::Le(1.5 * step)));
  EXPECT_THAT(closed(0.0285, 1), ElementsAre(at(0)));
  config.retries = 0;
  EXPECT_THAT(closed(0.15, 1), ElementsAre(at(0)));
}

TEST_F(BaggingEnvTest, CloseCarryLeavesLipsAloneThatAreTogetherOrUnseen) {
  const double apart = config_.close_carry.lips_apart_m;
  const Mouth together{{0, -0.1, 0}, {0, -0.1 + 0.9 * apart, 0}};
  const Mouth open{{0, -0.1, 0}, {0, -0.1 + 1.1 * apart, 0}};
  const auto moves = [&](const std::optional<Mouth>& mouth) {
    rig_.moves.clear();
    ToolMotion tool(rig_, config_.motion);
    CloseCarry(tool, {0, 0, 0}, {1, 0, 0}, mouth, {0, 0, 0}, config_.close_carry,
               config_.scratch_drag, config_.grasp_lift, config_.motion);
    return HeldPath().size();
  };
  EXPECT_EQ(moves(std::nullopt), 2u);
  EXPECT_EQ(moves(together), 2u);
  EXPECT_EQ(moves(open), 5u);
}

TEST_F(BaggingEnvTest, ARefusedMotionEndsTheActionLetsGoRisesAndLeavesTheView) {
  const std::vector<int> states = {0, 1, 2, 3};
  for (const int state : states) {
    for (const MoveEnd refusal : {MoveEnd::kUnreachable, MoveEnd::kProtectiveStop}) {
      rig_.refusal = refusal;
      for (rig_.refuse_at = 0; rig_.refuse_at < 3; ++rig_.refuse_at) {
        const Outcome outcome = Act(state, 0, state);
        EXPECT_NE(outcome.log["note"].get<std::string>(), "");
        EXPECT_EQ(rig_.moves.back().kind, Move::kWaitingPose);
        const Move& home = rig_.moves[rig_.moves.size() - 2];
        EXPECT_GE(home.X_WT.translation().z(), config_.motion.approach_m - 1e-9);
        const auto fingers = std::find_if(rig_.moves.rbegin(), rig_.moves.rend(),
                                          [](const Move& m) { return m.kind == Move::kFingers; });
        EXPECT_EQ(fingers->value, 0.085);
        EXPECT_EQ(outcome.next.state, state);
      }
    }
  }
}

TEST_F(BaggingEnvTest, AnArmThatCannotLeaveTheViewLetsGoAndTriesAgain) {
  (void)Act(3, 0, 4);
  // The waiting pose is the last motion; refuse it.
  int motions = 0;
  for (const Move& move : rig_.moves) motions += move.kind != Move::kFingers;
  rig_.refuse_at = motions - 1;
  const Outcome outcome = Act(3, 0, 4);
  EXPECT_THAT(outcome.log["note"].get<std::string>(), testing::HasSubstr("second try: reached"));
}

TEST_F(BaggingEnvTest, ALookBetweenStrokesIsTriedAgainToo) {
  (void)Act(0, 9, 1);
  int first_look = 0;
  for (const Move& move : rig_.moves) {
    if (move.kind == Move::kWaitingPose) break;
    first_look += move.kind != Move::kFingers;
  }
  rig_.refuse_at = first_look;
  rig_.unchanged_looks = 3;  // the one that is refused among them
  EXPECT_EQ(Act(0, 9, 1).log["note"], "");
  EXPECT_EQ(HeldPath().size() / 4, 3u) << "and the pulls go on";
}

TEST_F(BaggingEnvTest, StartsAndRestoresThroughTheScene) {
  EXPECT_EQ(env_.Begin(env_.Start(StartKind::kFolded, 1), 9).state, 0);
  EXPECT_EQ(rig_.sensor_seed, 9u);
  EXPECT_EQ(env_.Begin(env_.Start(StartKind::kUnfolded, 1), 10).state, 1);
}

TEST_F(BaggingEnvTest, FramesAreWrittenBeforeAndAfter) {
  (void)Act(0, 0, 1);
  rig_.truth.bag_area_px2 = 123;
  const FrameWriter frames = env_.Frames();
  (void)Act(1, 0, 2);  // the frames do not change any more
  frames(dir_ / "step0", {{"reward", 0.5}});
  const nlohmann::json about = ReadJson(dir_ / "step0.json");
  EXPECT_EQ(about["reward"], 0.5);
  for (const auto& [when, state] : {std::pair("before", 0), {"after", 1}}) {
    const std::string stem = (dir_ / "step0_").string() + when;
    const cv::Mat depth = cv::imread(stem + "_depth.png", cv::IMREAD_UNCHANGED);
    EXPECT_EQ(depth.type(), CV_16UC1);
    EXPECT_FALSE(cv::imread(stem + "_overlay.png").empty());
    EXPECT_EQ(about[when]["state"], state);
    EXPECT_GT(about[when]["A_bag"], 1000);
    // The masks show where perception saw cloth (blue) and labels (green): all of the bag's area,
    // but for what opening and closing the mask changes at its edge.
    const cv::Mat masks = cv::imread(stem + "_masks.png");
    ASSERT_EQ(masks.size(), cv::imread(stem + ".png").size());
    cv::Mat cloth;
    cv::inRange(masks, cv::Scalar(0, 0, 0), cv::Scalar(255, 255, 0), cloth);
    cv::Mat black;
    cv::inRange(masks, cv::Scalar(0, 0, 0), cv::Scalar(0, 0, 0), black);
    const double area = cv::countNonZero(cloth) - cv::countNonZero(black);
    EXPECT_NEAR(area, about[when]["A_bag"].get<double>(), 0.05 * area) << when;
  }
  EXPECT_THROW(frames(dir_ / "no" / "folder", {}), InputError);
}

TEST(BaggingConfig, WhatIsWrittenReadsBack) {
  ConfigTree tree;
  tree.Parse("[thresholds]\nA_oth = 701\n[thresholds_published]\nA_oth = 150\n", "bag.toml");
  tree.Set("thresholds.source=published");
  tree.Set("primitives.grasp_lift.pull_m=0.1");
  BaggingConfig config;
  config.Read(tree);
  EXPECT_NO_THROW(tree.RefuseUnknown());
  EXPECT_EQ(config.chosen_thresholds().A_oth, 150);
  std::string text;
  config.AppendTo(text);
  ConfigTree again;
  again.Parse(text, "config.toml");
  BaggingConfig back;
  back.Read(again);
  EXPECT_NO_THROW(again.RefuseUnknown());
  EXPECT_EQ(back.chosen_thresholds().A_oth, 150);
  EXPECT_EQ(back.thresholds.gusset.A_oth, 701);
  EXPECT_EQ(back.grasp_lift.pull_m, 0.1);
  std::string text_again;
  back.AppendTo(text_again);
  EXPECT_EQ(text, text_again);
}

TEST(BaggingConfig, PublishedThresholdsMustExist) {
  ConfigTree tree;
  tree.Set("thresholds.source=published");
  BaggingConfig config;
  EXPECT_THROW(config.Read(tree), InputError);
}

}  // namespace
}  // namespace gusset
