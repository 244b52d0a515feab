#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/config.h"
#include "base/error.h"
#include "sim/render/variation.h"

namespace gusset {
namespace {

const Eigen::Vector2d kCube(0.42, 0);

SceneLook Nominal() {
  SceneLook look;
  look.bag_rgb = {0.84f, 0.83f, 0.79f};
  look.label_rgb = {0.58f, 0.78f, 0.35f};
  look.canvas_rgb = {0.09f, 0.11f, 0.12f};
  look.labels_per_layer = 5;
  return look;
}

bool SameLight(const LightConfig& a, const LightConfig& b) {
  return a.azimuth_deg == b.azimuth_deg && a.elevation_deg == b.elevation_deg &&
         a.contrast == b.contrast && a.shadow == b.shadow && a.uneven == b.uneven &&
         a.gain == b.gain && a.red == b.red && a.blue == b.blue;
}

bool SameLook(const SceneLook& a, const SceneLook& b) {
  bool same = SameLight(a.light, b.light) && a.bag_rgb == b.bag_rgb && a.label_rgb == b.label_rgb &&
              a.canvas_rgb == b.canvas_rgb && a.labels_per_layer == b.labels_per_layer &&
              a.canvas_seed == b.canvas_seed && a.X_CD.matrix() == b.X_CD.matrix() &&
              a.clutter.size() == b.clutter.size();
  for (std::size_t i = 0; same && i < a.clutter.size(); ++i) {
    same = a.clutter[i].mesh.vertices == b.clutter[i].mesh.vertices &&
           a.clutter[i].X_WM.matrix() == b.clutter[i].X_WM.matrix() &&
           a.clutter[i].rgb == b.clutter[i].rgb;
  }
  return same;
}

VariationConfig Full() {
  VariationConfig config;
  config.amount = 1;
  return config;
}

TEST(Variation, AmountZeroIsTheNominalLookToTheBit) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_TRUE(SameLook(Vary(Nominal(), {}, kCube, seed), Nominal()));
  }
}

TEST(Variation, SameSeedsSameLookOtherSeedsAnother) {
  VariationConfig other = Full();
  other.seed = 1;
  const SceneLook look = Vary(Nominal(), Full(), kCube, 7);
  EXPECT_TRUE(SameLook(look, Vary(Nominal(), Full(), kCube, 7)));
  EXPECT_FALSE(SameLook(look, Vary(Nominal(), Full(), kCube, 8)));
  EXPECT_FALSE(SameLook(look, Vary(Nominal(), other, kCube, 7)));
}

// From both sides: never beyond the bounds, and somewhere in the outer part of each.
TEST(Variation, EverythingStaysWithinItsBoundsAndUsesThem) {
  const VariationConfig config = Full();
  const SceneLook nominal = Nominal();
  double farthest_m = 0, most_turn_rad = 0, most_gain = 0, most_colour = 0, most_canvas = 0;
  std::size_t most_clutter = 0;
  int fewest_labels = 5;
  for (std::uint64_t seed = 0; seed < 1000; ++seed) {
    const SceneLook look = Vary(nominal, config, kCube, seed);
    farthest_m = std::max(farthest_m, look.X_CD.translation().norm());
    most_turn_rad = std::max(most_turn_rad, Eigen::AngleAxisd(look.X_CD.linear()).angle());
    most_gain = std::max(most_gain, std::abs(look.light.gain - 1));
    most_colour =
        std::max<double>(most_colour, (look.bag_rgb - nominal.bag_rgb).cwiseAbs().maxCoeff());
    most_canvas =
        std::max<double>(most_canvas, std::abs(look.canvas_rgb[0] / nominal.canvas_rgb[0] - 1));
    most_clutter = std::max(most_clutter, look.clutter.size());
    fewest_labels = std::min(fewest_labels, look.labels_per_layer);
    EXPECT_LE(look.labels_per_layer, 5);
    EXPECT_NO_THROW(ValidateOrThrow("light", [&] {
      LightConfig light = look.light;  // azimuths go round; the bound is one of the config's
      light.azimuth_deg = std::remainder(light.azimuth_deg, 360);
      if (light.azimuth_deg < -180) light.azimuth_deg += 360;
      return light;
    }()));
  }
  EXPECT_LE(farthest_m, 0.003);
  EXPECT_GT(farthest_m, 0.0025);
  EXPECT_LE(most_turn_rad, 1 * std::numbers::pi / 180);
  EXPECT_GT(most_turn_rad, 0.8 * std::numbers::pi / 180);
  EXPECT_LE(most_gain, 0.12);
  EXPECT_GT(most_gain, 0.11);
  EXPECT_LE(most_colour, 0.12 + 1e-6);
  EXPECT_GT(most_colour, 0.10);
  EXPECT_LE(most_canvas, 0.3 + 1e-6);
  EXPECT_GT(most_canvas, 0.28);
  EXPECT_EQ(most_clutter, 4u);
  EXPECT_EQ(fewest_labels, 4);
}

TEST(Variation, AmountScalesTheCamerasWay) {
  VariationConfig half = Full();
  half.amount = 0.5;
  const Eigen::Vector3d whole_way = Vary(Nominal(), Full(), kCube, 3).X_CD.translation();
  EXPECT_TRUE(Vary(Nominal(), half, kCube, 3).X_CD.translation().isApprox(0.5 * whole_way, 1e-12));
}

TEST(Variation, ThreeLabelsAtLeastRemainWhereThereWereThree) {
  VariationConfig config = Full();
  config.labels_missing = 10;
  SceneLook few = Nominal();
  few.labels_per_layer = 2;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    EXPECT_GE(Vary(Nominal(), config, kCube, seed).labels_per_layer, 3);
    EXPECT_EQ(Vary(few, config, kCube, seed).labels_per_layer, 2);
  }
}

TEST(Variation, ClutterStaysOutOfTheRegionOfInterestAndOffTheCube) {
  VariationConfig config = Full();
  config.clutter = 20;
  int blocks = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Eigen::Vector2d cube = seed % 2 == 0 ? kCube : Eigen::Vector2d(-0.4, 0.2);
    for (const Clutter& block : Vary(Nominal(), config, cube, seed).clutter) {
      ++blocks;
      double outermost_to_roi = -1, nearest_to_cube = 1;
      Eigen::Vector2d least(1, 1), most(-1, -1);
      for (const Eigen::Vector3f& v : block.mesh.vertices) {
        const Eigen::Vector3d p = block.X_WM * v.cast<double>();
        EXPECT_GE(p.z(), -1e-6);
        least = least.cwiseMin(p.head<2>());
        most = most.cwiseMax(p.head<2>());
        nearest_to_cube = std::min(nearest_to_cube, (p.head<2>() - cube).norm());
      }
      // 340 px at 577 px/m, half: 0.295 m; blocks are lower than 40 mm, which leans out by 4 %.
      outermost_to_roi =
          std::max({least.x() - 0.295, least.y() - 0.295, -0.295 - most.x(), -0.295 - most.y()});
      EXPECT_GT(outermost_to_roi, 0.012);
      EXPECT_GT(nearest_to_cube, 0.0175 * std::sqrt(2.0));
    }
  }
  EXPECT_GT(blocks, 500);
}

TEST(Variation, BoundsAreChecked) {
  EXPECT_NO_THROW(ValidateOrThrow("variation", VariationConfig{}));
  EXPECT_THROW(ValidateOrThrow("variation", VariationConfig{.amount = 1.5}), InputError);
  EXPECT_THROW(ValidateOrThrow("variation", VariationConfig{.camera_mm = -1}), InputError);
}

}  // namespace
}  // namespace gusset
