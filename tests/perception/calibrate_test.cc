#include "perception/calibrate.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "perception/perceive.h"
#include "tests/perception/synthetic_frame.h"

namespace gusset {
namespace {

Observation LookAt(const RgbdFrame& frame) {
  return Perceive(frame, synthetic::Camera(), PerceptionConfig(), BagThresholds());
}

Observation FlatLook(const synthetic::Pose& pose) {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFlatBag(frame, pose);
  synthetic::DrawCube(frame, {566, 240});
  return LookAt(frame);
}

Observation FoldedLook() {
  RgbdFrame frame = synthetic::EmptyTable();
  synthetic::DrawFoldedBag(frame);
  synthetic::DrawCube(frame, {566, 240});
  return LookAt(frame);
}

// Flat Bag 1 covers 34,950 px^2 to half a pixel along its edge of 750 px.
TEST(Calibration, OfBag1GivesItsOwnThresholds) {
  std::vector<Observation> looks;
  for (const double yaw : {0.0, 0.3, -0.4, 1.2}) looks.push_back(FlatLook({{322, 241}, yaw}));
  const Calibration found = CalibrateThresholds(looks, 5);
  const BagThresholds bag1;
  EXPECT_EQ(found.flat_looks, 4);
  EXPECT_EQ(found.labels_seen, 5);
  EXPECT_NEAR(found.thresholds.A_flat, bag1.A_flat, 0.03 * bag1.A_flat);
  EXPECT_NEAR(found.thresholds.A_th, bag1.A_th, 0.03 * bag1.A_th);
  EXPECT_NEAR(found.thresholds.A_oth, bag1.A_oth, 0.03 * bag1.A_oth);
  EXPECT_NEAR(found.thresholds.A_bmax, bag1.A_bmax, 0.03 * bag1.A_bmax);
  EXPECT_NEAR(found.thresholds.A_omax, bag1.A_omax, 0.03 * bag1.A_omax);
}

TEST(Calibration, FoldedBagsAmongTheLooksChangeNothing) {
  std::vector<Observation> looks = {FlatLook({}), FlatLook({{310, 236}, 0.2}),
                                    FlatLook({{330, 238}, -0.2})};
  const double alone = CalibrateThresholds(looks, 5).thresholds.A_th;
  looks.insert(looks.begin(), 2, FoldedLook());
  EXPECT_EQ(CalibrateThresholds(looks, 5).thresholds.A_th, alone);
}

TEST(Calibration, RefusesLooksThatCannotTell) {
  const Observation flat = FlatLook({});
  EXPECT_THROW((void)CalibrateThresholds({}, 5), InputError);
  EXPECT_THROW((void)CalibrateThresholds({flat, flat}, 5), InputError);
  const Observation folded = FoldedLook();
  EXPECT_THROW((void)CalibrateThresholds({folded, folded, folded}, 5), InputError) << "no labels";
  const Observation cut = FlatLook({{200, 240}, 0});
  ASSERT_TRUE(cut.bag_at_border);
  EXPECT_THROW((void)CalibrateThresholds({cut, cut, cut}, 5), InputError);
}

}  // namespace
}  // namespace gusset
