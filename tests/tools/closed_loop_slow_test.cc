// The task by physics and from images alone, with the default bag, as train and evaluate wire it.

#include <gtest/gtest.h>

#include <optional>
#include <set>

#include "agents/bagging_env.h"
#include "base/random.h"
#include "sim/snapshot.h"
#include "tools/gusset/settings.h"

namespace gusset {
namespace {

constexpr std::uint64_t kSeed = 13;

class ClosedLoop : public ::testing::Test {
 protected:
  // The outcome of an action from `from`, the first of `tries` drawn at random that `wanted` likes.
  template <class Wanted>
  std::optional<Outcome> Try(const Snapshot& from, int state, int tries, Wanted wanted) {
    const int actions = env_.ActionCounts()[static_cast<std::size_t>(state)];
    Rng rng(DeriveSeed(kSeed, "closed loop", static_cast<std::uint64_t>(state)));
    for (int k = 0; k < tries; ++k) {
      EXPECT_EQ(env_.Begin(from, static_cast<std::uint64_t>(k)).state, state);
      Outcome outcome = env_.Act(rng.Below(actions));
      seen_.insert(outcome.next.state);
      disagreements_ += outcome.next.state != outcome.truth.state;
      ++actions_;
      if (wanted(outcome)) return outcome;
    }
    return std::nullopt;
  }

  Settings settings_ = LoadSettings({}, {.bag = "bag1"});
  std::unique_ptr<Testbed> testbed_ = MakeTestbed(settings_.tree);
  BaggingEnv env_{testbed_->scene(), testbed_->camera(), testbed_->robot(), testbed_->referee(),
                  settings_.bagging};
  std::set<int> seen_;
  int disagreements_ = 0, actions_ = 0;
};

// Random actions, each step begun from what the last one left: folded bag (s0), unfolded (s1), open
// (s2), cube in (s3), carried away (s4); and from s3 another grasp leaves the cube behind (s5).
TEST_F(ClosedLoop, ReachesAllSixStatesByPhysicsAndRecognisesThem) {
  const Snapshot folded = env_.Start(StartKind::kFolded, kSeed);
  EXPECT_EQ(env_.Begin(folded, 1).state, 0);
  seen_.insert(0);
  const Snapshot flat = env_.Start(StartKind::kUnfolded, kSeed);
  EXPECT_EQ(env_.Begin(flat, 1).state, 1);
  seen_.insert(1);

  const auto open = Try(flat, 1, 30, [](const Outcome& o) {
    return o.next.state == 2 && o.truth.state == 2 && o.truth.opening_area_px2 > 2000 &&
           o.log["A_o"].get<double>() > 2000;
  });
  ASSERT_TRUE(open) << "no scratch-and-drag of 30 opens the bag";
  const auto filled = Try(
      open->after, 2, 9, [](const Outcome& o) { return o.next.state == 3 && o.truth.cube_in_bag; });
  ASSERT_TRUE(filled) << "no pick-and-place of 9 puts the cube in";
  const auto carried = Try(filled->after, 3, 40,
                           [](const Outcome& o) { return o.next.state == 4 && o.true_success; });
  ASSERT_TRUE(carried) << "no close-and-carry of 40 takes the bag away";
  EXPECT_TRUE(carried->truth.cube_in_bag);
  EXPECT_TRUE(carried->truth.bag_held);
  EXPECT_GT(carried->truth.lowest_point_m, 0.15);
  EXPECT_TRUE(carried->true_success);
  EXPECT_EQ(carried->reward, 1);
  // Held far behind its mouth, where the point says and not beside it at the rim, the bag tips
  // over; not weighed, it is carried off without the cube.
  BaggingConfig deep = settings_.bagging;
  deep.close_carry.rim_inset_m = 1;
  deep.close_carry.filled_N = 0;
  BaggingEnv careless(testbed_->scene(), testbed_->camera(), testbed_->robot(), testbed_->referee(),
                      deep);
  std::optional<Outcome> dropped;
  int lost_at = -1;
  for (int point = 80; point >= 0 && !dropped; point -= 4) {
    (void)careless.Begin(filled->after, static_cast<std::uint64_t>(point));
    Outcome outcome = careless.Act(point);
    if (outcome.next.state != 5) continue;
    dropped = std::move(outcome);
    lost_at = point;
  }
  ASSERT_TRUE(dropped) << "no careless carry loses the cube";
  seen_.insert(dropped->next.state);
  EXPECT_FALSE(dropped->truth.cube_in_bag);
  EXPECT_FALSE(dropped->true_success);
  EXPECT_LT(dropped->truth.lowest_point_m, 0.03) << "the cube lies on the table";

  // The same, weighed: the bag comes back.
  deep.close_carry.filled_N = settings_.bagging.close_carry.filled_N;
  BaggingEnv weighing(testbed_->scene(), testbed_->camera(), testbed_->robot(), testbed_->referee(),
                      deep);
  (void)weighing.Begin(filled->after, static_cast<std::uint64_t>(lost_at));
  const Outcome back = weighing.Act(lost_at);
  EXPECT_EQ(back.log["note"], "too light: laid down again");
  EXPECT_FALSE(back.done);
  EXPECT_FALSE(back.truth.bag_held);
  EXPECT_LT(back.next.state, 4);

  EXPECT_EQ(seen_.size(), 6u);
  for (const Outcome& reached : {*open, *filled, *carried, *dropped}) {
    EXPECT_EQ(reached.next.state, reached.truth.state);
  }
  // Twenty more, for of few actions chance decides. Random ones leave bags near the thresholds, and
  // labels that touch are seen as one, so that A_o is seen too small: measured, 6 of 27 disagree.
  (void)Try(flat, 1, 20, [](const Outcome&) { return false; });
  EXPECT_GT(actions_, 20);
  EXPECT_LE(disagreements_, actions_ / 3) << "of " << actions_ << " states seen and true";
}

TEST_F(ClosedLoop, AnActionGivesTheSameBitsWhateverRanBefore) {
  const Snapshot flat = env_.Start(StartKind::kUnfolded, 5);
  (void)env_.Begin(flat, 3);
  const Outcome first = env_.Act(40);
  (void)env_.Begin(env_.Start(StartKind::kUnfolded, 6), 3);
  (void)env_.Act(7);
  (void)env_.Begin(flat, 3);
  const Outcome again = env_.Act(40);
  EXPECT_EQ(first.after, again.after);
  EXPECT_EQ(first.reward, again.reward);
  EXPECT_EQ(first.log.dump(), again.log.dump());
}

// A cube that is squeezed out of the fingers, or kicked as they open, lies elsewhere.
TEST_F(ClosedLoop, TheCubeStaysWhereItIsPlaced) {
  const auto open = Try(env_.Start(StartKind::kUnfolded, kSeed), 1, 30, [](const Outcome& o) {
    return o.next.state == 2 && o.log["A_o"].get<double>() > 2000;
  });
  ASSERT_TRUE(open) << "no scratch-and-drag of 30 leaves room for the cube";
  for (int point = 0; point < 9; ++point) {
    (void)env_.Begin(open->after, 1);
    const Eigen::Vector3d place = env_.before().place_points[point].p_W;
    WorldState world;
    SimRobotState robot;
    const Outcome outcome = env_.Act(point);
    EXPECT_EQ(outcome.log["note"], "");
    UnpackSnapshot(outcome.after, world, robot);
    const Eigen::Vector3d off = world.cube.X_WB.translation() - place;
    EXPECT_LT(off.head<2>().norm(), 0.06) << "place point " << point;
  }
}

}  // namespace
}  // namespace gusset
