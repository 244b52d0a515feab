#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <vector>

namespace gusset {

/// Groups of four constraints that share no node, for solving one per lane: indices into `nodes`,
/// -1 for lanes left empty at a group's end.
///
/// Every node meets its constraints in the order given, so going through the groups gives the same
/// bits as going through the constraints, forwards and backwards. Constraints that have to wait for
/// equally many others come together: what is next rarely needs what is still being computed.
template <std::size_t N>
std::vector<std::array<int, 4>> PackFours(const std::vector<std::array<int, N>>& nodes,
                                          std::size_t node_count) {
  constexpr std::size_t kLookAhead = 64;
  std::vector<int> rank(nodes.size()), met(node_count, 0), order(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (const int n : nodes[i]) rank[i] = std::max(rank[i], met[n]);
    for (const int n : nodes[i]) met[n] = rank[i] + 1;
  }
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return rank[i] < rank[j]; });
  std::vector<std::array<int, 4>> fours;
  std::vector<std::size_t> seen_in(node_count, 0);  // number of the last group that saw the node
  while (!order.empty()) {
    fours.push_back({-1, -1, -1, -1});
    std::size_t filled = 0, kept = 0, i = 0;
    for (; i < order.size() && filled < 4 && i < kLookAhead; ++i) {
      bool clear = true;
      for (const int n : nodes[order[i]]) {
        clear = clear && seen_in[n] != fours.size();
        seen_in[n] = fours.size();
      }
      // What is passed over blocks its nodes for what comes later.
      if (clear) {
        fours.back()[filled++] = order[i];
      } else {
        order[kept++] = order[i];
      }
    }
    order.erase(order.begin() + static_cast<std::ptrdiff_t>(kept),
                order.begin() + static_cast<std::ptrdiff_t>(i));
  }
  return fours;
}

}  // namespace gusset
