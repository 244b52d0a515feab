#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"
#include "sim/cloth/closest_points.h"
#include "sim/cloth/simd8.h"

namespace gusset {
namespace {

Vec4f RandomPoint(Rng& rng) {
  const auto draw = [&] { return static_cast<float>(rng.Uniform(-0.02, 0.02)); };
  const float x = draw(), y = draw(), z = draw();
  return {x, y, z, 0};
}

Vec3x4 Everywhere(const Vec4f& p) { return {p.x(), p.y(), p.z()}; }

float Lane0(Float4 v) {
  alignas(16) std::array<float, 4> lanes;
  v.Store(lanes.data());
  return lanes[0];
}

// The grid's points are 1/64 of a 50 mm side apart, so its best is within 1 mm of the true one, and
// cannot be better than it but for rounding.
TEST(ClosestOnTriangle, IsAsCloseAsTheBestOfAGrid) {
  Rng rng(1);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec4f p = RandomPoint(rng), a = RandomPoint(rng), b = RandomPoint(rng),
                c = RandomPoint(rng);
    const Barycentric<Float4> w =
        ClosestOnTriangle(Everywhere(p), Everywhere(a), Everywhere(b), Everywhere(c));
    const float wa = Lane0(w.a), wb = Lane0(w.b), wc = Lane0(w.c);
    EXPECT_NEAR(wa + wb + wc, 1.0f, 1e-5f);
    EXPECT_GE(std::min({wa, wb, wc}), -1e-6f);
    const float distance = (p - wa * a - wb * b - wc * c).norm();
    float best = 1;
    for (int i = 0; i <= 64; ++i) {
      for (int j = 0; i + j <= 64; ++j) {
        const float u = static_cast<float>(i) / 64, v = static_cast<float>(j) / 64;
        best = std::min(best, (p - (1 - u - v) * a - u * b - v * c).norm());
      }
    }
    EXPECT_LE(distance, best + 1e-6f);
    EXPECT_GE(distance, best - 1e-3f);
  }
}

TEST(ClosestOnSegments, AreAsCloseAsTheBestOfAGrid) {
  Rng rng(2);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec4f a = RandomPoint(rng), b = RandomPoint(rng), c = RandomPoint(rng),
                d = RandomPoint(rng);
    const SegmentPoints<Float4> w =
        ClosestOnSegments(Everywhere(a), Everywhere(b), Everywhere(c), Everywhere(d));
    const float s = Lane0(w.s), t = Lane0(w.t);
    EXPECT_TRUE(s >= 0 && s <= 1 && t >= 0 && t <= 1);
    const float distance = (a + s * (b - a) - c - t * (d - c)).norm();
    float best = 1;
    for (int i = 0; i <= 64; ++i) {
      for (int j = 0; j <= 64; ++j) {
        const float u = static_cast<float>(i) / 64, v = static_cast<float>(j) / 64;
        best = std::min(best, (a + u * (b - a) - c - v * (d - c)).norm());
      }
    }
    EXPECT_LE(distance, best + 1e-6f);
    EXPECT_GE(distance, best - 1e-3f);
  }
}

TEST(ClosestOnSegments, OfParallelOnesLieInTheMiddleOfTheirOverlap) {
  const Vec4f a(0, 0, 0, 0), b(0.02f, 0, 0, 0), c(0.01f, 0.002f, 0, 0), d(0.03f, 0.002f, 0, 0);
  const SegmentPoints<Float4> w =
      ClosestOnSegments(Everywhere(a), Everywhere(b), Everywhere(c), Everywhere(d));
  EXPECT_NEAR(Lane0(w.s), 0.75f, 1e-5f);
  EXPECT_NEAR(Lane0(w.t), 0.25f, 1e-5f);
}

// Eight lanes are two times four: the same bits, so that results do not depend on what a build
// uses.
TEST(ClosestPoints, OfEightAreThoseOfFourAndFour) {
  Rng rng(3);
  for (int trial = 0; trial < 100; ++trial) {
    std::array<Vec4Array, 4> p;  // [corner][lane]
    for (Vec4Array& corner : p) {
      for (int lane = 0; lane < 8; ++lane) corner.push_back(RandomPoint(rng));
    }
    const std::array<int, 8> all = {0, 1, 2, 3, 4, 5, 6, 7};
    const auto at8 = [&](int k) { return Gather(p[k].data(), all); };
    const auto at4 = [&](int k, int from) {
      return Gather(p[k].data(), from, from + 1, from + 2, from + 3);
    };
    const Barycentric<Float8> b = ClosestOnTriangle(at8(0), at8(1), at8(2), at8(3));
    const SegmentPoints<Float8> w = ClosestOnSegments(at8(0), at8(1), at8(2), at8(3));
    for (const int from : {0, 4}) {
      const auto half = [&](Float8 v) { return from == 0 ? v.low() : v.high(); };
      const Barycentric<Float4> b4 =
          ClosestOnTriangle(at4(0, from), at4(1, from), at4(2, from), at4(3, from));
      const SegmentPoints<Float4> w4 =
          ClosestOnSegments(at4(0, from), at4(1, from), at4(2, from), at4(3, from));
      const Float4 same = (half(b.a) == b4.a) & (half(b.b) == b4.b) & (half(b.c) == b4.c) &
                          (half(w.s) == w4.s) & (half(w.t) == w4.t);
      EXPECT_EQ(Bits(same), 15) << trial;
    }
  }
}

}  // namespace
}  // namespace gusset
