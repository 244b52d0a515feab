#include "sim/render/cloth_texture.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/random.h"
#include "sim/render/creases.h"

namespace gusset {
namespace {

/// Smooth tileable noise of unit range: random values on a `cells` x `cells` torus, bilinear.
float LatticeNoise(const cv::Mat_<float>& lattice, float x, float y) {
  const int n = lattice.rows;
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  const int xa = x0 % n, xb = (x0 + 1) % n, ya = y0 % n, yb = (y0 + 1) % n;
  return (lattice(ya, xa) * (1 - fx) + lattice(ya, xb) * fx) * (1 - fy) +
         (lattice(yb, xa) * (1 - fx) + lattice(yb, xb) * fx) * fy;
}

cv::Mat_<float> RandomLattice(int n, std::uint64_t seed) {
  Rng rng(seed);
  cv::Mat_<float> lattice(n, n);
  for (float& value : lattice) value = static_cast<float>(rng.Uniform(-1, 1));
  return lattice;
}

/// 1 inside [lo, hi], 0 outside, a ramp of width `soft` at both ends.
float Band(float x, float lo, float hi, float soft) {
  return std::clamp(std::min(x - lo, hi - x) / soft + 0.5f, 0.0f, 1.0f);
}

/// How a layer that lies flat is shaded all the same: two folds that ironing left, pulls of the
/// cloth in all directions, and shallow waves. Strengths as in figure 5.2 b, c (tuned by eye).
cv::Mat_<float> Wrinkles(int layer, const Eigen::Vector2f& extent_m, cv::Size pixels) {
  constexpr auto kRight = static_cast<float>(std::numbers::pi / 2);
  Rng rng(DeriveSeed(1, "cloth wrinkles", static_cast<std::uint64_t>(layer)));
  const Eigen::Vector2f px_per_m(static_cast<float>(pixels.width) / extent_m.x(),
                                 static_cast<float>(pixels.height) / extent_m.y());
  const cv::Mat_<float> waves = RandomLattice(16, rng.Bits());
  cv::Mat_<float> map(pixels);
  for (int row = 0; row < map.rows; ++row) {
    const float v = static_cast<float>(row) / px_per_m.y();
    for (int column = 0; column < map.cols; ++column) {
      // Slope towards the light of a surface whose waves are some 3 cm wide.
      const float x = static_cast<float>(column) / px_per_m.x() * 30, y = v * 22;
      map(row, column) =
          0.018f * (LatticeNoise(waves, x + 0.5f, y + 0.5f) - LatticeNoise(waves, x, y));
    }
  }
  AddCrease(map, px_per_m,
            {{0.64f * extent_m.x(), 0.45f * extent_m.y()},
             kRight,
             0.8f * extent_m.y(),
             0.1f,
             0.0025f,
             0.045f});
  AddCrease(map, px_per_m,
            {{0.5f * extent_m.x(), 0.36f * extent_m.y()},
             0.02f,
             0.8f * extent_m.x(),
             0.1f,
             0.0030f,
             0.030f});
  const Crease least{.length_m = 0.05f, .bend_1_m = -4, .width_m = 0.003f, .strength = 0.012f};
  const Crease most{.length_m = 0.20f, .bend_1_m = 4, .width_m = 0.010f, .strength = 0.045f};
  for (int i = 0; i < 18; ++i) {
    AddCrease(map, px_per_m, RandomCrease(extent_m, kRight, kRight, least, most, rng));
  }
  return map;
}

}  // namespace

cv::Mat ClothTexture(const ClothItem& cloth, int layer, const Eigen::Vector2f& extent_m,
                     cv::Size pixels) {
  // Sizes of a sewn cotton bag as in the published pictures: a 12 mm hem, stitches 3 mm from edges.
  constexpr float kHem = 0.012f, kStitch = 0.003f, kThread = 0.0012f, kSoft = 0.0012f;
  const cv::Mat_<float> patches = RandomLattice(24, DeriveSeed(1, "cloth patches", layer));
  const cv::Mat_<float> slubs = RandomLattice(128, DeriveSeed(1, "cloth slubs", layer));
  const cv::Mat_<float> wrinkles = Wrinkles(layer, extent_m, pixels);
  cv::Mat texture(pixels, CV_8UC3);
  for (int row = 0; row < pixels.height; ++row) {
    const float v =
        (static_cast<float>(row) + 0.5f) / static_cast<float>(pixels.height) * extent_m.y();
    for (int column = 0; column < pixels.width; ++column) {
      const float u =
          (static_cast<float>(column) + 0.5f) / static_cast<float>(pixels.width) * extent_m.x();
      const float edge = std::min({u, extent_m.x() - u, extent_m.y() - v});
      float shade = 1 + wrinkles(row, column) + 0.012f * LatticeNoise(patches, u * 80, v * 80) +
                    // Threads are thicker here and there, along the weave's two directions.
                    0.012f * LatticeNoise(slubs, u * 150, v * 1200) +
                    0.012f * LatticeNoise(slubs, u * 1200, v * 150);
      shade *= 1 - 0.10f * Band(v, kHem - kThread / 2, kHem + kThread / 2, kSoft);
      shade *= 1 + 0.02f * Band(v, 0, kHem, kSoft);  // the hem is double and shines through less
      shade *= 1 - 0.08f * Band(edge, kStitch - kThread / 2, kStitch + kThread / 2, kSoft);
      Eigen::Vector3f rgb = cloth.rgb;
      for (const LabelPatch& label : cloth.labels) {
        if (label.layer != layer) continue;
        const float cover =
            std::min(Band(u, label.u0, label.u1, kSoft), Band(v, label.v0, label.v1, kSoft));
        const float worn = 1 + 0.10f * LatticeNoise(patches, u * 250 + 7, v * 250);
        rgb = rgb * (1 - cover) + cloth.label_rgb * (worn * cover);
      }
      rgb *= shade * 255;
      texture.at<cv::Vec3b>(row, column) =
          cv::Vec3b(cv::saturate_cast<uchar>(rgb.x()), cv::saturate_cast<uchar>(rgb.y()),
                    cv::saturate_cast<uchar>(rgb.z()));
    }
  }
  return texture;
}

cv::Mat FabricTexture(int pixels, float side_m, std::uint64_t seed) {
  constexpr auto kRight = static_cast<float>(std::numbers::pi / 2);
  Rng rng(DeriveSeed(seed, "fabric"));
  const cv::Mat_<float> coarse = RandomLattice(5, rng.Bits());
  const cv::Mat_<float> middle = RandomLattice(23, rng.Bits());
  const cv::Mat_<float> fine = RandomLattice(pixels, rng.Bits());
  cv::Mat texture(pixels, pixels, CV_32FC1);
  for (int row = 0; row < pixels; ++row) {
    for (int column = 0; column < pixels; ++column) {
      const float x = static_cast<float>(column) / static_cast<float>(pixels);
      const float y = static_cast<float>(row) / static_cast<float>(pixels);
      // Threads: as fine as the map across, long along the columns and, fainter, along the rows.
      const auto n = static_cast<float>(pixels);
      texture.at<float>(row, column) =
          0.18f * LatticeNoise(coarse, 5 * x, 5 * y) +
          0.12f * LatticeNoise(middle, 23 * x, 23 * y) + 0.22f * LatticeNoise(fine, n * x, 40 * y) +
          0.10f * LatticeNoise(fine, 40 * x + 11, n * y + 17) + 0.10f * fine(row, column);
    }
  }
  // Folds as in figure 5.2 e: most along the columns, some aslant (tuned by eye).
  const Eigen::Vector2f px_per_m = Eigen::Vector2f::Constant(static_cast<float>(pixels) / side_m);
  const Eigen::Vector2f extent = Eigen::Vector2f::Constant(side_m);
  const Crease least{.length_m = 0.03f, .bend_1_m = -2, .width_m = 0.004f, .strength = 0.15f};
  const Crease most{.length_m = 0.22f, .bend_1_m = 2, .width_m = 0.008f, .strength = 0.55f};
  for (int i = 0; i < 40; ++i) {
    AddCrease(texture, px_per_m, RandomCrease(extent, kRight, 0.3f, least, most, rng));
  }
  for (int i = 0; i < 12; ++i) {
    AddCrease(texture, px_per_m, RandomCrease(extent, 0, 0.7f, least, most, rng));
  }
  return texture;
}

}  // namespace gusset
