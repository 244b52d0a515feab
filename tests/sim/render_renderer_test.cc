#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "sim/render/backdrop.h"
#include "sim/render/bounds.h"
#include "sim/render/renderer.h"
#include "sim/render/statics.h"
#include "tests/sim/render_bag.h"

namespace gusset {
namespace {

constexpr double kCameraHeight_m = 1.066;

CameraModel Overhead() { return OverheadCamera({}, kCameraHeight_m); }

/// World to clip coordinates of the overhead camera, y down as rows are.
Eigen::Matrix4f OverheadClip() {
  const Pinhole p;
  Eigen::Matrix4f clip = Eigen::Matrix4f::Zero();
  clip(0, 0) = static_cast<float>(2 * p.fx / p.width);
  clip(0, 3) =
      static_cast<float>((2 * p.cx + 1) / p.width - 1) * static_cast<float>(kCameraHeight_m);
  clip(0, 2) = -clip(0, 3) / static_cast<float>(kCameraHeight_m);
  clip(1, 1) = static_cast<float>(-2 * p.fy / p.height);
  clip(1, 3) =
      static_cast<float>((2 * p.cy + 1) / p.height - 1) * static_cast<float>(kCameraHeight_m);
  clip(1, 2) = -clip(1, 3) / static_cast<float>(kCameraHeight_m);
  clip(3, 2) = -1;
  clip(3, 3) = static_cast<float>(kCameraHeight_m);
  return clip;
}

RenderItem At(const TriMesh& mesh, const Eigen::Vector3d& centre, const Eigen::Vector3f& rgb) {
  RenderItem item;
  item.mesh = &mesh;
  item.X_WM.translation() = centre;
  item.rgb = rgb;
  return item;
}

bool Same(const RgbdFrame& a, const RgbdFrame& b) {
  return cv::norm(a.color, b.color, cv::NORM_INF) == 0 &&
         cv::norm(a.depth_mm, b.depth_mm, cv::NORM_INF) == 0;
}

/// The scene of the pictures: table, cube, bag.
class RenderedScene : public testing::Test {
 protected:
  RenderedScene() : cube_(BoxMesh({0.035, 0.035, 0.035})) {
    view_.items = statics_.items();
    view_.items.push_back(At(cube_, {0.42, 0, 0.0175}, kCubeRgb));
  }
  Statics statics_;
  TriMesh cube_;
  SceneView view_;
  Renderer renderer_;
};

TEST_F(RenderedScene, TableIsAtTheCamerasHeightInEveryPixel) {
  view_.items.resize(2);  // canvas and table
  const RgbdFrame frame = renderer_.Render(view_, Overhead());
  ASSERT_EQ(frame.color.type(), CV_8UC3);
  ASSERT_EQ(frame.depth_mm.type(), CV_16UC1);
  double least = 0, most = 0;
  cv::minMaxLoc(frame.depth_mm, &least, &most);
  // The table lies 1 mm under the canvas.
  EXPECT_EQ(least, 1066);
  EXPECT_EQ(most, 1067);
  EXPECT_EQ(frame.depth_mm.at<std::uint16_t>(240, 320), 1066);
}

TEST_F(RenderedScene, DepthOfATiltedPlaneIsTheDistanceAlongTheAxis) {
  const CameraModel camera = LookAt({0.5, 0.4, 0.8}, {0, 0, 0}, {});
  view_.items.resize(1);  // canvas
  const RgbdFrame frame = renderer_.Render(view_, camera);
  for (int row = 20; row < 480; row += 40) {
    for (int column = 20; column < 640; column += 40) {
      const Eigen::Vector3d p_W = camera.OntoPlane(cv::Point2d(column, row), 0);
      if (std::abs(p_W.x()) > 0.33 || std::abs(p_W.y()) > 0.33) continue;
      const double expected_mm = 1000 * (camera.X_WC.inverse() * p_W).z();
      // Half a millimetre of rounding; the rest is the depth buffer's float.
      EXPECT_NEAR(frame.depth_mm.at<std::uint16_t>(row, column), expected_mm, 0.51);
    }
  }
}

TEST(Renderer, NothingToSeeIsNoDepth) {
  const RgbdFrame frame = Renderer().Render({}, Overhead());
  EXPECT_EQ(cv::countNonZero(frame.depth_mm), 0);
}

TEST(Renderer, ABoxCoversThePixelsWhoseCentresItCovers) {
  const TriMesh box = BoxMesh({0.1013, 0.0617, 0.02});
  SceneView view;
  view.items = {At(box, {0.1231, 0.0517, 0.01}, {1, 1, 1})};
  const CameraModel camera = Overhead();
  const RgbdFrame frame = Renderer().Render(view, camera);
  // The top face hides the sides' far half but not the half towards the image's centre; so only the
  // far edges, right and top, are compared, where the outline is the top face's own.
  const cv::Point2d corner = camera.Project({0.1231 + 0.1013 / 2, 0.0517 + 0.0617 / 2, 0.02});
  const cv::Rect covered = cv::boundingRect(frame.depth_mm > 0);
  EXPECT_EQ(covered.br().x - 1, static_cast<int>(std::floor(corner.x)));
  EXPECT_EQ(covered.y, static_cast<int>(std::ceil(corner.y)));
  EXPECT_EQ(frame.depth_mm.at<std::uint16_t>(covered.y + 5, covered.br().x - 5), 1046);
}

TEST_F(RenderedScene, ColourAndDepthShowTheSameSurface) {
  const TriMesh block = BoxMesh({0.1, 0.1, 0.1});
  view_.items.resize(1);
  view_.items.push_back(At(block, {0.1, 0.1, 0.05}, {0.9f, 0.1f, 0.1f}));
  const RgbdFrame frame = renderer_.Render(view_, Overhead());
  cv::Mat red;
  cv::inRange(frame.color, cv::Scalar(0, 0, 100), cv::Scalar(80, 80, 255), red);
  cv::Mat above = frame.depth_mm < 1064;
  above.setTo(0, frame.depth_mm == 0);
  // The rows of the sides that meet the table are within 2 mm of it: at most one row and column.
  EXPECT_LE(cv::countNonZero(red != above), 2 * 58);
  EXPECT_GT(cv::countNonZero(red), 57 * 57);
}

TEST_F(RenderedScene, AFlatBagCoversAsManyPixelsAsInThePublishedFigure) {
  view_.cloth = FlatBag();
  const RgbdFrame frame = renderer_.Render(view_, Overhead());
  const cv::Mat bag = frame.depth_mm(cv::Rect(150, 70, 340, 340)) < 1066;
  // Figure 5.2 b; 1 % is 1.5 mm on each side.
  EXPECT_NEAR(cv::countNonZero(bag), 34950, 350);
  // Two layers of 1.5 mm.
  EXPECT_EQ(frame.depth_mm.at<std::uint16_t>(240, 320), 1063);
}

TEST_F(RenderedScene, FramesDoNotDependOnWhatWasDrawnBefore) {
  view_.cloth = CrumpledBag();
  const RgbdFrame first = renderer_.Render(view_, Overhead());
  EXPECT_TRUE(Same(first, renderer_.Render(view_, Overhead())));
  SceneView other = view_;
  other.cloth = FlatBag();
  other.cloth.labels.clear();
  other.light.gain = 0.5;
  EXPECT_FALSE(Same(first, renderer_.Render(other, Overhead())));
  (void)renderer_.Render({}, LookAt({1, 1, 1}, {0, 0, 0}, {.width = 320, .height = 200}));
  EXPECT_TRUE(Same(first, renderer_.Render(view_, Overhead())));
  EXPECT_TRUE(Same(first, Renderer().Render(view_, Overhead())));
}

// From the third look at what stands still, only parts are drawn.
TEST_F(RenderedScene, OverABackdropFramesAreTheSame) {
  const CameraModel cameras[] = {Overhead(), LookAt({0.9, 0.8, 0.7}, {0, 0, 0.1}, {})};
  const TriMesh arm = BoxMesh({0.1, 0.5, 0.08});
  view_.cloth = CrumpledBag();
  view_.items.push_back(At(arm, {0.1, 0, 0.4}, {0.8f, 0.5f, 0.2f}));
  RenderItem& cube = view_.items[view_.items.size() - 2];
  int others = 0;
  for (const double elevation_deg : {62.0, 25.0}) {
    view_.light.elevation_deg = elevation_deg;
    for (const CameraModel& camera : cameras) {
      for (int look = 0; look < 3; ++look) renderer_.Render(view_, camera);
      RgbdFrame last;
      for (const Eigen::Vector3d& at :
           {Eigen::Vector3d(0.42, 0, 0.0175), Eigen::Vector3d(-0.1, 0.1, 0.2),
            Eigen::Vector3d(0.05, -0.30, 0.05), Eigen::Vector3d(0.0, -0.40, 0.43),
            Eigen::Vector3d(0.47, 0.36, 0.1), Eigen::Vector3d(-0.6, -0.5, 0.3),
            Eigen::Vector3d(0.0, 0.02, 0.95)}) {
        cube.X_WM.translation() = at;
        const RgbdFrame frame = renderer_.Render(view_, camera);
        EXPECT_TRUE(Same(frame, Renderer().Render(view_, camera)))
            << "cube at " << at.transpose() << ", light at " << elevation_deg;
        others += !last.color.empty() && !Same(frame, last);
        last = frame;
      }
      view_.items.back().X_WM.translation().y() += 0.1;
    }
  }
  EXPECT_GE(others, 20);  // of 24: but for those out of sight, places show
}

TEST_F(RenderedScene, ABackdropIsOfWhatStandsStillNow) {
  TriMesh block = BoxMesh({0.1, 0.1, 0.05});
  view_.items.push_back(At(block, {0.2, 0.25, 0.025}, {0.3f, 0.4f, 0.6f}));
  view_.items.back().still = true;
  const std::size_t last = view_.items.size() - 1;
  const std::function<void()> changes[] = {
      [&] { view_.canvas_seed = 7; },
      [&] { view_.light.gain = 0.8; },
      [&] { view_.items[kCanvasItem].rgb.x() += 0.1f; },
      [&] { view_.items[kCanvasItem].mottle = 0.1f; },
      [&] { view_.items[last].contrast = 0.8f; },
      [&] { view_.items[last].X_WM.translation().x() += 0.05; },
      [&] {
        block = BoxMesh({0.05, 0.15, 0.08});
      },
      [&] { view_.items[last].still = false; },
      [&] { view_.items.pop_back(); }};
  RgbdFrame before = renderer_.Render(view_, Overhead());
  for (std::size_t k = 0; k < std::size(changes); ++k) {
    for (int look = 0; look < 3; ++look) before = renderer_.Render(view_, Overhead());
    changes[k]();
    const RgbdFrame after = renderer_.Render(view_, Overhead());
    EXPECT_TRUE(Same(after, Renderer().Render(view_, Overhead()))) << "change " << k;
    EXPECT_EQ(Same(after, before), k == 7) << "change " << k << " shows, but for a mere hint";
  }
}

TEST_F(RenderedScene, ASmallThingChangesASmallPart) {
  SceneView still = view_;
  still.items.pop_back();
  Backdrop backdrop;
  EXPECT_FALSE(backdrop.NoteLook(still, Overhead()));
  EXPECT_FALSE(backdrop.NoteLook(still, Overhead()));
  EXPECT_TRUE(backdrop.NoteLook(still, Overhead()));
  backdrop.Keep(renderer_.Render(still, Overhead()));
  const Corners canvas = Bounds{{-0.34f, -0.34f, -0.02f}, {0.34f, 0.34f, 0}}.corners();
  const Corners cube = Bounds{{0.1f, 0.1f, 0}, {0.135f, 0.135f, 0.035f}}.corners();
  const std::vector<cv::Rect> parts = backdrop.ChangedParts(
      {cube}, {canvas}, OverheadClip(), Eigen::Vector2f(-0.3f, 0.4f), 0.02f, 0.46f);
  ASSERT_EQ(parts.size(), 1u);
  // 35 mm are 20 px; the shadow reaches 18 mm further, and 20 mm more each way for its blur.
  EXPECT_LT(parts[0].area(), 60 * 60);
  EXPECT_GT(parts[0].area(), 40 * 40);
  EXPECT_TRUE(backdrop.NoteLook(still, Overhead()));
  EXPECT_FALSE(backdrop.NoteLook(view_, Overhead()));
  EXPECT_FALSE(backdrop.kept());
}

TEST(PixelsOf, CoversThePixelsOfABoxAndFewMore) {
  const TriMesh box = BoxMesh({0.1, 0.06, 0.02});
  SceneView view;
  view.items = {At(box, {0.1, 0.05, 0.01}, {1, 1, 1})};
  Renderer renderer;
  const RgbdFrame frame = renderer.Render(view, Overhead());
  const cv::Rect seen = cv::boundingRect(cv::Mat(frame.depth_mm > 0));
  const Eigen::Matrix4f clip = OverheadClip();
  const cv::Rect pixels =
      PixelsOf(Bounds{{0.05f, 0.02f, 0}, {0.15f, 0.08f, 0.02f}}.corners(), clip, {640, 480});
  EXPECT_EQ(pixels & seen, seen);
  EXPECT_LE(pixels.width, seen.width + 4);
  EXPECT_LE(pixels.height, seen.height + 4);
  EXPECT_TRUE(PixelsOf(Bounds{{2, 2, 0}, {2.1f, 2.1f, 0.1f}}.corners(), clip, {640, 480}).empty());
  // Around the camera.
  EXPECT_EQ(PixelsOf(Bounds{{-1, -1, 0}, {1, 1, 2}}.corners(), clip, {640, 480}),
            cv::Rect(0, 0, 640, 480));
}

TEST(Renderer, AMeshThatChangedInPlaceIsDrawnAnew) {
  TriMesh mesh = BoxMesh({0.1, 0.1, 0.1});
  SceneView view;
  view.items = {At(mesh, {0, 0, 0}, {1, 1, 1})};
  Renderer renderer;
  (void)renderer.Render(view, Overhead());
  mesh = BoxMesh({0.1, 0.1, 0.3});
  const RgbdFrame frame = renderer.Render(view, Overhead());
  EXPECT_EQ(frame.depth_mm.at<std::uint16_t>(240, 320), 916);
}

// Perception's bounds (authors' HSV ranges, brightness of labels eased to 90) must hold in the
// deepest crease, or a bag would have holes.
TEST_F(RenderedScene, ColoursStayWithinPerceptionsBoundsInEveryFold) {
  view_.cloth = CrumpledBag();
  const RgbdFrame frame = renderer_.Render(view_, Overhead());
  cv::Mat hsv, cream, green, canvas;
  cv::cvtColor(frame.color, hsv, cv::COLOR_BGR2HSV);
  cv::inRange(hsv, cv::Scalar(0, 0, 103), cv::Scalar(179, 107, 255), cream);
  cv::inRange(hsv, cv::Scalar(32, 50, 90), cv::Scalar(85, 255, 255), green);
  cv::inRange(hsv, cv::Scalar(0, 0, 0), cv::Scalar(179, 255, 60), canvas);
  const cv::Rect roi(150, 70, 340, 340);
  const cv::Mat bag = frame.depth_mm(roi) < 1065;
  ASSERT_GT(cv::countNonZero(bag), 5000);
  EXPECT_EQ(cv::countNonZero(bag & ~(cream(roi) | green(roi))), 0);
  const cv::Mat rest = frame.depth_mm(roi) >= 1066;
  EXPECT_EQ(cv::countNonZero(rest & ~canvas(roi)), 0);
}

TEST_F(RenderedScene, TheCubeIsRedOnEveryFace) {
  const RgbdFrame frame = renderer_.Render(view_, Overhead());
  cv::Mat hsv;
  cv::cvtColor(frame.color, hsv, cv::COLOR_BGR2HSV);
  const cv::Rect around(545, 220, 45, 40);
  int pixels = 0;
  for (int row = around.y; row < around.br().y; ++row) {
    for (int column = around.x; column < around.br().x; ++column) {
      if (frame.depth_mm.at<std::uint16_t>(row, column) > 1060) continue;
      const cv::Vec3b c = hsv.at<cv::Vec3b>(row, column);
      EXPECT_TRUE(c[0] <= 10 || c[0] >= 170);
      EXPECT_GT(c[1], 150);
      ++pixels;
    }
  }
  // Top face 35 mm at 597 px/m, and a side.
  EXPECT_GT(pixels, 21 * 21);
}

TEST_F(RenderedScene, LabelsShowOnBothSidesOfALayer) {
  view_.cloth = FlatBag();
  const auto label_pixels = [this] {
    cv::Mat hsv, green;
    cv::cvtColor(renderer_.Render(view_, Overhead()).color, hsv, cv::COLOR_BGR2HSV);
    cv::inRange(hsv, cv::Scalar(32, 50, 90), cv::Scalar(85, 255, 255), green);
    return cv::countNonZero(green);
  };
  // Five patches of 12 x 14 mm at 577 px/m, half a pixel of soft edge on three sides.
  const double expected = 5 * 12 * 14 * 0.577 * 0.577;
  EXPECT_NEAR(label_pixels(), expected, 0.35 * expected);
  // Only the upper layer, turned over: what shows is its inner side.
  for (Eigen::Vector3f& p : view_.cloth.x) p = {-p.x(), p.y(), 0.004f - p.z()};
  std::erase_if(view_.cloth.labels, [](const LabelPatch& label) { return label.layer == 1; });
  EXPECT_NEAR(label_pixels(), expected, 0.35 * expected);
}

TEST(LookAt, ShowsTheTargetInTheMiddleUpright) {
  const CameraModel camera = LookAt({0.8, 0.9, 0.7}, {0.1, -0.1, 0.2}, {});
  const cv::Point2d target = camera.Project({0.1, -0.1, 0.2});
  EXPECT_NEAR(target.x, 320, 1e-9);
  EXPECT_NEAR(target.y, 240, 1e-9);
  EXPECT_LT(camera.Project({0.1, -0.1, 0.3}).y, 240);
  EXPECT_NEAR(camera.X_WC.linear().determinant(), 1, 1e-12);
}

TEST(LookAt, StraightDownIsTheOverheadCamera) {
  EXPECT_TRUE(LookAt({0, 0, kCameraHeight_m}, {0, 0, 0}, {}).X_WC.isApprox(Overhead().X_WC));
}

TEST_F(RenderedScene, RefusesWhatIsNotFinite) {
  view_.cloth = FlatBag();
  view_.cloth.x[7].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)renderer_.Render(view_, Overhead()), InputError);
  view_.cloth = {};
  view_.items[0].X_WM.translation().x() = std::numeric_limits<double>::infinity();
  EXPECT_THROW((void)renderer_.Render(view_, Overhead()), InputError);
}

TEST_F(RenderedScene, RefusesClothWhoseArraysDoNotFit) {
  view_.cloth = FlatBag();
  view_.cloth.uv.pop_back();
  EXPECT_THROW((void)renderer_.Render(view_, Overhead()), InputError);
  view_.cloth = FlatBag();
  view_.cloth.triangle_layer.pop_back();
  EXPECT_THROW((void)renderer_.Render(view_, Overhead()), InputError);
}

TEST(Renderer, NamesItsDriver) {
  EXPECT_NE(Renderer().gl_renderer().find("llvmpipe"), std::string::npos);
}

}  // namespace
}  // namespace gusset
