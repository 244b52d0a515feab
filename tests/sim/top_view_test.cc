#include "sim/top_view.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/random.h"
#include "sim/render/renderer.h"
#include "sim/render/statics.h"
#include "tests/sim/render_bag.h"

namespace gusset {
namespace {

const CameraModel kCamera = OverheadCamera({}, 1.066);
constexpr std::array<int, 4> kFrame = {0, 0, 640, 480};

// Nodes of the flat bag around the table's middle, the rim towards -y.
Vec3Array Flat(const BagConfig& bag, const ClothMesh& mesh) {
  Vec3Array x(mesh.rest.begin(), mesh.rest.end());
  for (Vec3f& p : x) {
    p.x() -= static_cast<float>(0.5 * bag.opening_m);
    p.y() -= static_cast<float>(0.5 * bag.depth_m);
  }
  return x;
}

TopView LookAt(const BagConfig& bag, const Vec3Array& x, const TriMesh* cube_W = nullptr) {
  return LookAtBag(MakeBagMesh(bag), x, MakeLabels(bag), kCamera, kFrame, cube_W);
}

long Count(const TopView& view, Shown shown) { return std::ranges::count(view.shown, shown); }

TEST(TopView, AFlatBagShowsTheOutsideOfItsUpperLayer) {
  const BagConfig bag;
  const TopView view = LookAt(bag, Flat(bag, MakeBagMesh(bag)));
  // A pixel row may belong to either of two triangles along the seams, where layers meet.
  EXPECT_NEAR(Count(view, Shown::kOuter1), view.bag_px, 0.01 * view.bag_px);
  EXPECT_EQ(Count(view, Shown::kInner0) + Count(view, Shown::kInner1) + view.cube_px, 0);
  EXPECT_NEAR(view.bag_px, 34950, 0.01 * 34950);
}

TEST(TopView, TurnedOverItShowsTheOutsideOfTheOther) {
  const BagConfig bag;
  Vec3Array x = Flat(bag, MakeBagMesh(bag));
  for (Vec3f& p : x) p = {-p.x(), p.y(), 0.01f - p.z()};
  const TopView view = LookAt(bag, x);
  EXPECT_NEAR(Count(view, Shown::kOuter0), view.bag_px, 0.01 * view.bag_px);
}

// The upper layer's rim half folded back onto itself: the lower layer's inside shows beside the
// upper layer's inside, which is now on top.
TEST(TopView, AMouthDrawnBackShowsBothInsides) {
  const BagConfig bag;
  const ClothMesh mesh = MakeBagMesh(bag);
  Vec3Array x = Flat(bag, mesh);
  float top = 0;
  for (const Vec3f& p : x) top = std::max(top, p.z());
  for (Vec3f& p : x) {
    const float fold = static_cast<float>(-0.5 * bag.depth_m + 0.06);
    if (p.z() < top || p.y() >= fold) continue;
    p.y() = 2 * fold - p.y();
    p.z() += 0.01f;
  }
  const TopView view = LookAt(bag, x);
  EXPECT_GT(Count(view, Shown::kInner0), 1000);
  EXPECT_GT(Count(view, Shown::kInner1), 1000);
  // Where the lower layer shows it is near the rim: at most the 0.06 m and a node's spacing.
  for (std::size_t at = 0; at < view.shown.size(); ++at) {
    if (view.shown[at] != Shown::kInner0) continue;
    ASSERT_LE(view.rim_m[at], 0.06 + 0.021);
  }
}

// The cube's face at 0.035 m covers (0.035 * 615 / 1.031)^2 = 436 px^2, less than a pixel row of
// error.
TEST(TopView, TheCubeShowsWhereNoClothIsAboveIt) {
  const BagConfig bag;
  const Vec3Array x = Flat(bag, MakeBagMesh(bag));
  TriMesh cube = BoxMesh(Eigen::Vector3d::Constant(0.035));
  for (Eigen::Vector3f& p : cube.vertices) p.z() += 0.03f;
  const TopView on_top = LookAt(bag, x, &cube);
  EXPECT_NEAR(on_top.cube_px, 440, 42);
  EXPECT_EQ(on_top.bag_px, LookAt(bag, x).bag_px) << "the bag is there under the cube too";
  for (Eigen::Vector3f& p : cube.vertices) p.z() -= 0.2f;
  EXPECT_EQ(LookAt(bag, x, &cube).cube_px, 0);
}

// As many pixels again in each direction, and three times: counts of pixels are then sharper.
const CameraModel kTwice = OverheadCamera({1230, 1230, 320, 240, 640, 480}, 1.066);
const CameraModel kThrice = OverheadCamera({1845, 1845, 320, 240, 640, 480}, 1.066);

TopView LookAtDrawn(const ClothItem& cloth, const std::vector<LabelPatch>& labels,
                    const CameraModel& camera) {
  ClothSurface surface(cloth);
  surface.Update(cloth);
  return LookAtBag(surface, labels, camera, kFrame);
}

TopView LookAtFlat(const ClothItem& cloth, const std::vector<LabelPatch>& labels,
                   const CameraModel& camera) {
  return LookAtBag(MakeBagMesh(BagConfig()), Vec3Array(cloth.x.begin(), cloth.x.end()), labels,
                   camera, kFrame);
}

void Turn(ClothItem& cloth, float angle) {
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(angle, Eigen::Vector3f::UnitZ()).toRotationMatrix();
  for (Eigen::Vector3f& p : cloth.x) p = turn * p;
}

TEST(TopView, AFlatBagIsAsLargeDrawnAsItsMesh) {
  ClothItem cloth = FlatBag();
  Turn(cloth, 0.2f);  // edges then cross rows of pixel centres all along, and none jumps as a whole
  const std::vector<LabelPatch> labels = MakeLabels(BagConfig());
  const TopView flat = LookAtFlat(cloth, labels, kTwice);
  const TopView drawn = LookAtDrawn(cloth, labels, kTwice);
  // The shell's upper side is half a thickness nearer: 0.14 % of the area. The rest is rounding.
  const double nearer = 1 + cloth.thickness_m / kTwice.X_WC.translation().z();
  EXPECT_NEAR(drawn.bag_px, nearer * flat.bag_px, 0.0005 * flat.bag_px);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    EXPECT_NEAR(drawn.label_px[k], nearer * flat.label_px[k], 0.02 * flat.label_px[k])
        << "label " << k;
  }
}

// Cloth bent round a cylinder along x, with labels that go over the side that a camera sees last.
//
//     ------__A__          A: the top. The labels reach from the angle `from` to beyond 90 degrees:
//             | /  \       from above, width * radius * (1 - sin from) of each shows.
//             |/    L
//             +-----L      The mesh's chords are 39 degrees long (20.6 mm), so that its side falls
//                  /       short of the radius by up to 1.7 mm of the 5.4 mm that show.
//                _/
// The labels begin at the share `phase` of a chord.
// What the drawn cloth shows of them, as a share of what a round surface shows.
double ShownOfBentLabels(double phase) {
  constexpr double kRadius_m = 0.03, kFrom = 55 * std::numbers::pi / 180;
  constexpr double kFirst = -60 * std::numbers::pi / 180, kLast = 170 * std::numbers::pi / 180;
  // So high above that perspective is 0.3 %, and 1165 px/m: a label shows some 90 px^2.
  const CameraModel camera = OverheadCamera({12300, 12300, 320, 240, 640, 480}, 10.66);
  const double px_per_m = 12300 / (10.66 - 0.1);
  const double row_m = 0.35 / 17;
  const double v0 = (2 + phase) * row_m;
  ClothItem cloth = FlatBag();
  for (std::size_t n = 0; n < cloth.x.size(); ++n) {
    const double angle = kFrom + (cloth.uv[n].y() - v0) / kRadius_m;
    const double bent = std::clamp(angle, kFirst, kLast);
    const double on = (angle - bent) * kRadius_m;  // straight on beyond the bend
    cloth.x[n].y() = static_cast<float>(kRadius_m * std::sin(bent) + on * std::cos(bent));
    cloth.x[n].z() = static_cast<float>(0.1 + kRadius_m * std::cos(bent) - on * std::sin(bent));
  }
  Turn(cloth, 0.4f);
  std::vector<LabelPatch> labels;
  for (int k = 0; k < 9; ++k) {
    LabelPatch label;
    label.u0 = static_cast<float>(0.03 * (k + 1) - 0.006);
    label.u1 = static_cast<float>(0.03 * (k + 1) + 0.006);
    label.v0 = static_cast<float>(v0);
    label.v1 = static_cast<float>(v0 + 0.03);
    labels.push_back(label);
    label.layer = 1;  // the layers lie in the same place: either may show
    labels.push_back(label);
  }
  const auto shown_px = [&](const TopView& view) {
    return std::accumulate(view.label_px.begin(), view.label_px.end(), 0.0) / 9;
  };
  const double per_radius_px = 0.012 * (1 - std::sin(kFrom)) * px_per_m * px_per_m;
  const double shell_m = kRadius_m + 0.5 * cloth.thickness_m;
  return shown_px(LookAtDrawn(cloth, labels, camera)) / (per_radius_px * shell_m);
}

TEST(TopView, BentLabelsShowNearlyWhatARoundSurfaceShows) {
  for (const double phase : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    EXPECT_NEAR(ShownOfBentLabels(phase), 1, 0.2) << "phase " << phase;
  }
}

/// A heap of folds three to six nodes wide, another one with every seed.
ClothItem Crumpled(std::uint64_t seed) {
  struct Wave {
    Eigen::Vector2d per_m;
    double phase, amplitude_m;
  };
  Rng rng(seed);
  std::array<Wave, 9> waves;
  for (Wave& wave : waves) {
    const double per_m = rng.Uniform(50, 100), angle = rng.Uniform(0, 2 * std::numbers::pi);
    wave = {{per_m * std::cos(angle), per_m * std::sin(angle)},
            rng.Uniform(0, 2 * std::numbers::pi),
            0.5 / per_m};
  }
  ClothItem bag = FlatBag();
  for (Eigen::Vector3f& p : bag.x) {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < waves.size(); ++k) {
      const Wave& wave = waves[k];
      shift[static_cast<int>(k % 3)] +=
          wave.amplitude_m * std::sin(wave.per_m.dot(p.head<2>().cast<double>()) + wave.phase);
    }
    // The layers lie apart, and the rim of the lower one looks out.
    const double lower = p.z() < 0.0016f ? 0.012 : 0;
    p = {static_cast<float>(0.6 * p.x() + shift.x()),
         static_cast<float>(0.6 * p.y() + shift.y() - lower),
         static_cast<float>(0.05 + shift.z() + 6 * p.z())};
  }
  return bag;
}

// Area of one label in a picture, px: drawn green on red cloth in even light, a pixel counts by its
// share of green. The printed label's edges are soft, so that whole pixels would lose its corners.
double AreaInPicture(Renderer& renderer, const ClothItem& cloth, const LabelPatch& label,
                     const CameraModel& camera) {
  SceneView scene;
  scene.cloth = cloth;
  scene.cloth.rgb = {0.8f, 0, 0};
  scene.cloth.label_rgb = {0, 0.8f, 0};
  scene.cloth.labels = {{label.u0, label.u1, label.v0, label.v1, label.layer}};
  scene.light.contrast = scene.light.shadow = scene.light.uneven = 0;
  double area = 0;
  for (const cv::Vec3b& bgr : cv::Mat_<cv::Vec3b>(renderer.Render(scene, camera).color)) {
    const bool cloth_there = bgr[0] < 20;  // neither green nor red has any blue
    if (cloth_there) area += bgr[1] / (1.0 * bgr[1] + bgr[2]);
  }
  return area;
}

class CrumpledBags : public testing::TestWithParam<int> {};

TEST_P(CrumpledBags, ShowOfEachLabelWhatItsPictureShows) {
  const ClothItem cloth = Crumpled(static_cast<std::uint64_t>(GetParam()));
  const std::vector<LabelPatch> labels = MakeLabels(BagConfig());
  const TopView drawn = LookAtDrawn(cloth, labels, kThrice);
  const TopView flat = LookAtFlat(cloth, labels, kThrice);
  Renderer renderer;
  double off_drawn = 0, off_flat = 0;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const double picture = AreaInPicture(renderer, cloth, labels[k], kThrice);
    // One pixel of the camera's own, and 3 %: labels are printed a little unevenly.
    EXPECT_NEAR(drawn.label_px[k], picture, 9 + 0.03 * picture) << "label " << k;
    off_drawn += std::abs(drawn.label_px[k] - picture);
    off_flat += std::abs(flat.label_px[k] - picture);
  }
  EXPECT_LT(2 * off_drawn, off_flat) << "the middle surface would be little worse";
}
INSTANTIATE_TEST_SUITE_P(Seeds, CrumpledBags, testing::Range(1, 5));

}  // namespace
}  // namespace gusset
