#include "sim/render/cloth_texture.h"

#include <algorithm>
#include <cmath>

#include "base/random.h"

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

}  // namespace

cv::Mat ClothTexture(const ClothItem& cloth, int layer, const Eigen::Vector2f& extent_m,
                     cv::Size pixels) {
  // Sizes of a sewn cotton bag as in the published pictures: a 12 mm hem, stitches 3 mm from edges.
  constexpr float kHem = 0.012f, kStitch = 0.003f, kThread = 0.0012f, kSoft = 0.0012f;
  const cv::Mat_<float> patches = RandomLattice(24, DeriveSeed(1, "cloth patches", layer));
  const cv::Mat_<float> slubs = RandomLattice(128, DeriveSeed(1, "cloth slubs", layer));
  cv::Mat texture(pixels, CV_8UC3);
  for (int row = 0; row < pixels.height; ++row) {
    const float v =
        (static_cast<float>(row) + 0.5f) / static_cast<float>(pixels.height) * extent_m.y();
    for (int column = 0; column < pixels.width; ++column) {
      const float u =
          (static_cast<float>(column) + 0.5f) / static_cast<float>(pixels.width) * extent_m.x();
      const float edge = std::min({u, extent_m.x() - u, extent_m.y() - v});
      float shade = 1 + 0.012f * LatticeNoise(patches, u * 80, v * 80) +
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
        rgb = rgb * (1 - cover) + cloth.label_rgb * cover;
      }
      rgb *= shade * 255;
      texture.at<cv::Vec3b>(row, column) =
          cv::Vec3b(cv::saturate_cast<uchar>(rgb.x()), cv::saturate_cast<uchar>(rgb.y()),
                    cv::saturate_cast<uchar>(rgb.z()));
    }
  }
  return texture;
}

cv::Mat FabricTexture(int pixels) {
  const cv::Mat_<float> coarse = RandomLattice(5, DeriveSeed(1, "fabric coarse"));
  const cv::Mat_<float> middle = RandomLattice(23, DeriveSeed(1, "fabric middle"));
  const cv::Mat_<float> fine = RandomLattice(pixels, DeriveSeed(1, "fabric fine"));
  cv::Mat texture(pixels, pixels, CV_32FC1);
  for (int row = 0; row < pixels; ++row) {
    for (int column = 0; column < pixels; ++column) {
      const float x = static_cast<float>(column) / static_cast<float>(pixels);
      const float y = static_cast<float>(row) / static_cast<float>(pixels);
      texture.at<float>(row, column) = 0.5f * LatticeNoise(coarse, 5 * x, 5 * y) +
                                       0.3f * LatticeNoise(middle, 23 * x, 23 * y) +
                                       0.2f * fine(row, column);
    }
  }
  return texture;
}

}  // namespace gusset
