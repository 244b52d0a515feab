#include "sim/render/variation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "sim/render/statics.h"

namespace gusset {
namespace {

/// Uniform on [-most, most).
double Either(double most, Rng& rng) { return rng.Uniform(-most, most); }

/// Within a ball of radius `most`: the cube inside it, so that the bound holds in any direction.
Eigen::Vector3d InBall(double most, Rng& rng) {
  const double half = most / std::sqrt(3.0);
  Eigen::Vector3d v;
  for (double& value : v) value = Either(half, rng);
  return v;
}

Eigen::Vector3f Shifted(const Eigen::Vector3f& rgb, double most, Rng& rng) {
  const double all = Either(most, rng);
  Eigen::Vector3f shifted;
  for (int k = 0; k < 3; ++k) {
    shifted[k] = std::clamp(rgb[k] + static_cast<float>(all + Either(most, rng)), 0.0f, 1.0f);
  }
  return shifted;
}

/// Half the diagonal of the largest cube, 0.1 m, and some.
constexpr double kCubeClear_m = 0.08;

/// In the frame but outside the region of interest (|x|, |y| <= 0.295 m) and off the cube's place.
Eigen::Vector2d BorderPlace(double radius_m, const Eigen::Vector2d& cube_m, Rng& rng) {
  const double clear = 0.31 + radius_m;
  for (;;) {
    const Eigen::Vector2d p(Either(0.56, rng), Either(0.42, rng));
    const bool beside = p.cwiseAbs().maxCoeff() > clear;
    const bool on_cube = (p - cube_m).norm() < radius_m + kCubeClear_m;
    if (beside && !on_cube) return p;
  }
}

Clutter RandomBlock(const Eigen::Vector2d& cube_m, Rng& rng) {
  Clutter block;
  const Eigen::Vector3d size(rng.Uniform(0.01, 0.10), rng.Uniform(0.01, 0.05),
                             rng.Uniform(0.005, 0.04));
  block.mesh = BoxMesh(size);
  const Eigen::Vector2d place = BorderPlace(0.5 * size.head<2>().norm(), cube_m, rng);
  block.X_WM = Eigen::Translation3d(place.x(), place.y(), size.z() / 2) *
               Eigen::AngleAxisd(Either(std::numbers::pi, rng), Eigen::Vector3d::UnitZ());
  // Greys and blues: red things would be cubes to anyone.
  const double grey = rng.Uniform(0.1, 0.8);
  block.rgb = Eigen::Vector3d(grey, grey, std::min(1.0, grey + rng.Uniform(0, 0.2))).cast<float>();
  return block;
}

}  // namespace

SceneLook Vary(const SceneLook& nominal, const VariationConfig& config,
               const Eigen::Vector2d& cube_m, std::uint64_t seed) {
  if (config.amount <= 0) return nominal;
  const double amount = config.amount;
  Rng rng(DeriveSeed(static_cast<std::uint64_t>(config.seed), "variation", seed));
  SceneLook look = nominal;

  LightConfig& light = look.light;
  light.azimuth_deg += Either(amount * config.azimuth_deg, rng);
  light.elevation_deg =
      std::clamp(light.elevation_deg + Either(amount * config.elevation_deg, rng), 20.0, 90.0);
  light.gain *= 1 + Either(amount * config.light, rng);
  light.red *= 1 + Either(amount * config.light_colour, rng);
  light.blue *= 1 + Either(amount * config.light_colour, rng);
  light.contrast = std::clamp(light.contrast + Either(amount * config.contrast, rng), 0.0, 0.9);
  light.shadow = std::clamp(light.shadow + Either(amount * config.contrast, rng), 0.0, 1.0);
  light.uneven = std::clamp(light.uneven + Either(amount * config.contrast, rng), 0.0, 0.5);

  const Eigen::Vector3d turn = InBall(amount * config.camera_deg * std::numbers::pi / 180, rng);
  look.X_CD.linear() =
      Eigen::AngleAxisd(turn.norm(), turn.norm() > 0 ? Eigen::Vector3d(turn.normalized())
                                                     : Eigen::Vector3d::UnitX())
          .toRotationMatrix();
  look.X_CD.translation() = InBall(amount * config.camera_mm / 1000, rng);

  look.bag_rgb = Shifted(nominal.bag_rgb, amount * config.bag_colour, rng);
  look.label_rgb = Shifted(nominal.label_rgb, amount * config.label_colour, rng);
  look.canvas_rgb =
      nominal.canvas_rgb * static_cast<float>(1 + Either(amount * config.canvas_colour, rng));
  look.canvas_seed = rng.Bits();
  const int missing =
      static_cast<int>(rng.Uniform() * (1 + std::floor(amount * config.labels_missing)));
  look.labels_per_layer =
      std::max(nominal.labels_per_layer - missing, std::min(nominal.labels_per_layer, 3));
  const int blocks = static_cast<int>(rng.Uniform() * (1 + std::floor(amount * config.clutter)));
  for (int i = 0; i < blocks; ++i) look.clutter.push_back(RandomBlock(cube_m, rng));
  return look;
}

}  // namespace gusset
