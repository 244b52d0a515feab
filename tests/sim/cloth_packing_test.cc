#include <gtest/gtest.h>

#include <algorithm>

#include "base/random.h"
#include "sim/cloth/packing.h"

namespace gusset {
namespace {

TEST(PackFours, TakesEachOnceSharesNoNodeAndKeepsEveryNodesOrder) {
  constexpr int kNodes = 60, kConstraints = 400;
  Rng rng(1);
  std::vector<std::array<int, 3>> nodes;
  while (nodes.size() < kConstraints) {
    const std::array<int, 3> n = {static_cast<int>(rng.Below(kNodes)),
                                  static_cast<int>(rng.Below(kNodes)),
                                  static_cast<int>(rng.Below(kNodes))};
    if (n[0] != n[1] && n[0] != n[2] && n[1] != n[2]) nodes.push_back(n);
  }
  std::vector<int> last(kNodes, -1), group_of(kNodes, -1), seen(nodes.size(), 0);
  int group = 0;
  for (const std::array<int, 4>& four : PackFours(nodes, kNodes)) {
    EXPECT_GE(four[0], 0);
    for (int k = 0; k < 4; ++k) {
      if (four[k] < 0) continue;
      EXPECT_GE(four[std::max(k - 1, 0)], 0) << "empty lanes are last";
      ++seen[four[k]];
      for (const int n : nodes[four[k]]) {
        EXPECT_NE(group_of[n], group);
        EXPECT_LT(last[n], four[k]);
        group_of[n] = group;
        last[n] = four[k];
      }
    }
    ++group;
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
}

}  // namespace
}  // namespace gusset
