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

TEST(PackEights, TakesEachChainOnceWithItsLikeAndSharesNoNode) {
  constexpr int kNodes = 90, kChains = 60;
  Rng rng(2);
  std::vector<std::vector<int>> nodes;
  for (int i = 0; i < kChains; ++i) {
    const int length = 2 + static_cast<int>(rng.Below(3)), first = static_cast<int>(rng.Below(80));
    for (nodes.emplace_back(); static_cast<int>(nodes.back().size()) < length;) {
      nodes.back().push_back(first + 3 * static_cast<int>(nodes.back().size()));
    }
  }
  const std::vector<std::span<const int>> chains(nodes.begin(), nodes.end());
  std::vector<int> seen(kChains, 0);
  for (const auto& eight : PackEights(chains, kNodes)) {
    std::vector<int> used;
    ASSERT_GE(eight[0], 0);
    for (std::size_t k = 0; k < kLanes8; ++k) {
      if (eight[k] < 0) continue;
      EXPECT_GE(eight[k == 0 ? 0 : k - 1], 0) << "empty lanes are last";
      EXPECT_EQ(nodes[eight[k]].size(), nodes[eight[0]].size());
      ++seen[eight[k]];
      for (const int n : nodes[eight[k]]) {
        EXPECT_EQ(std::ranges::count(used, n), 0);
        used.push_back(n);
      }
    }
  }
  for (const int times : seen) EXPECT_EQ(times, 1);
}

}  // namespace
}  // namespace gusset
