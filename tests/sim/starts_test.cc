#include "sim/starts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/stop.h"
#include "sim/top_view.h"

namespace gusset {
namespace {

CameraModel Camera() { return OverheadCamera({615, 615, 320, 240, 640, 480}, 1.066); }

int Area(const Cloth& cloth, const BagConfig& bag) {
  return LookAtBag(cloth.mesh(), cloth.state().x, MakeLabels(bag), Camera(), {0, 0, 640, 480})
      .bag_px;
}

TEST(MakeFoldedStart, IsGivenUpWhenAStopIsAskedFor) {
  RequestStop();
  EXPECT_THROW(MakeFoldedStart(BagConfig(), ClothSolverConfig(), StartConfig(), Camera(), false, 1),
               Interrupted);
  ForgetStop();
}

// Seeds of the three kinds: pushed, folded, dropped.
class FoldedStart : public ::testing::TestWithParam<int> {};

TEST_P(FoldedStart, HidesTheMouthIsSmallAndStaysSo) {
  const BagConfig bag;
  const ClothSolverConfig solver;
  const StartConfig config;
  const Start start = MakeFoldedStart(bag, solver, config, Camera(), false, GetParam());
  Cloth cloth(MakeBagMesh(bag), bag, solver);
  cloth.SetState(start.cloth);
  const TopView view =
      LookAtBag(cloth.mesh(), start.cloth.x, MakeLabels(bag), Camera(), {0, 0, 640, 480});
  EXPECT_EQ(view.bag_px, start.area_px);
  EXPECT_GE(view.bag_px, config.folded_area_min_px);
  EXPECT_LE(view.bag_px, config.folded_area_max_px);
  EXPECT_LT(std::count_if(view.label_px.begin(), view.label_px.end(),
                          [&](int px) { return px >= config.label_seen_px; }),
            config.mouth_labels);
  EXPECT_EQ(CountCrossings(cloth.mesh(), start.cloth.x), 0);
  Vec3f mean = Vec3f::Zero();
  for (const Vec3f& p : start.cloth.x) mean += p / static_cast<float>(start.cloth.x.size());
  EXPECT_LE(mean.head<2>().norm(), config.centre_m + 1e-6);
  // Without internal friction a canvas bag springs open within a second.
  const float h = 1.0f / static_cast<float>(solver.substeps_per_s);
  std::vector<RigidShape> none;
  for (int i = 0; i < 3 * solver.substeps_per_s; ++i) {
    cloth.Predict(h);
    cloth.SolveConstraints(h, Eigen::Isometry3f::Identity(), none);
  }
  EXPECT_NEAR(Area(cloth, bag), start.area_px, 0.05 * start.area_px);
  EXPECT_LT(cloth.MaxStretch(), 1.1f);
}

INSTANTIATE_TEST_SUITE_P(Seeds, FoldedStart, ::testing::Values(1, 2, 7));

TEST(Starts, AreAFunctionOfTheirSeed) {
  const BagConfig bag;
  const Start a = MakeFoldedStart(bag, {}, {}, Camera(), false, 4);
  const Start b = MakeFoldedStart(bag, {}, {}, Camera(), false, 4);
  const Start other = MakeFoldedStart(bag, {}, {}, Camera(), false, 9);
  EXPECT_EQ(a.cloth.x, b.cloth.x);
  EXPECT_EQ(a.cloth.bend_set, b.cloth.bend_set);
  EXPECT_EQ(a.attempts, b.attempts);
  EXPECT_NE(a.cloth.x, other.cloth.x);
}

TEST(Starts, AnUnfoldedBagLiesFlatNearTheMiddle) {
  const BagConfig bag;
  for (const bool any_pose : {false, true}) {
    const StartConfig config;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const Start start = MakeUnfoldedStart(bag, {}, config, Camera(), any_pose, seed);
      EXPECT_NEAR(start.area_px, 34950, 700) << "0.30 x 0.35 m at 577 px/m";
      Vec3f mean = Vec3f::Zero(), low = start.cloth.x[0], high = low;
      for (const Vec3f& p : start.cloth.x) {
        mean += p / static_cast<float>(start.cloth.x.size());
        high = high.cwiseMax(p);
      }
      EXPECT_LE(mean.head<2>().norm(), (any_pose ? config.any_centre_m : config.centre_m) + 0.003);
      EXPECT_LT(high.z(), 4 * bag.thickness_m) << "two plies and the hem";
    }
  }
}

}  // namespace
}  // namespace gusset
