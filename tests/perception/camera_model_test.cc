#include "perception/camera_model.h"

#include <gtest/gtest.h>

namespace gusset {
namespace {

const CameraModel kCamera = OverheadCamera({}, 1.066);

TEST(CameraModel, ImageRightIsWorldXAndImageUpIsWorldY) {
  EXPECT_EQ(kCamera.Project({0, 0, 0}), cv::Point2d(320, 240));
  EXPECT_GT(kCamera.Project({0.1, 0, 0}).x, 320);
  EXPECT_LT(kCamera.Project({0, 0.1, 0}).y, 240);
}

// 615 px / 1.066 m = 577 px/m at the table; the cube's waiting place is given as pixel (566, 240),
// half way up its 35 mm.
TEST(CameraModel, ScaleIsThatOfTheScene) {
  EXPECT_NEAR(kCamera.Project({0.1, 0, 0}).x - 320, 57.7, 0.01);
  EXPECT_NEAR(kCamera.Project({0.42, 0, 0.0175}).x, 566, 0.5);
}

TEST(CameraModel, DeprojectUndoesProject) {
  const Eigen::Vector3d p_W(0.13, -0.07, 0.045);
  const cv::Point2d px = kCamera.Project(p_W);
  EXPECT_LT((kCamera.Deproject(px, 1.066 - 0.045) - p_W).norm(), 1e-12);
  EXPECT_LT((kCamera.OntoPlane(px, 0.045) - p_W).norm(), 1e-12);
}

}  // namespace
}  // namespace gusset
