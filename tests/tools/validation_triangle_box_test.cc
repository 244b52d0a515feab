#include <gtest/gtest.h>

#include "base/random.h"
#include "tests/validation/triangle_box.h"

namespace gusset {
namespace {

using Eigen::Vector3d;

TEST(TriangleBox, MeetsWhatReachesInto) {
  const Vector3d half(1, 2, 3);
  // Its corners are outside, its middle within; a corner that it cuts off; one corner within.
  EXPECT_TRUE(TriangleMeetsBox({-9, -9, 0}, {9, -9, 0}, {0, 18, 0}, half));
  EXPECT_TRUE(TriangleMeetsBox({2, 0.8, 0}, {0.2, 2.6, 0}, {2, 2.5, 9}, half));
  EXPECT_TRUE(TriangleMeetsBox({0.9, 0, 0}, {5, 1, 0}, {5, 0, 1}, half));
  // Beyond a face; past an edge, where only the product of two edges separates; past a corner.
  EXPECT_FALSE(TriangleMeetsBox({1.1, 0, 0}, {1.1, 1, 0}, {5, 0, 1}, half));
  EXPECT_FALSE(TriangleMeetsBox({2, 1.2, -4}, {0.2, 3, 4}, {3, 3, 0}, half));
  EXPECT_FALSE(TriangleMeetsBox({9, 0, 0}, {0, 9, 0}, {0, 0, 9}, half));
}

// Against points scattered over the triangle: what has one inside the box meets it.
TEST(TriangleBox, NeverMissesAPointInside) {
  Rng rng(1);
  const Vector3d half(1, 1, 1);
  const auto point = [&] {
    return Vector3d(rng.Uniform(-2, 2), rng.Uniform(-2, 2), rng.Uniform(-2, 2));
  };
  int met = 0, missed = 0;
  for (int i = 0; i < 500; ++i) {
    const Vector3d a = point(), b = point(), c = point();
    bool inside = false;
    for (int k = 0; k < 400; ++k) {
      double u = rng.Uniform(), v = rng.Uniform();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vector3d p = a + u * (b - a) + v * (c - a);
      inside = inside || (p.cwiseAbs() - half).maxCoeff() < 0;
    }
    const bool meets = TriangleMeetsBox(a, b, c, half);
    met += meets;
    missed += !meets;
    EXPECT_TRUE(meets || !inside);
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(missed, 50);
}

}  // namespace
}  // namespace gusset
