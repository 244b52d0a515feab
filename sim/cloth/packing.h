#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>
#include <span>
#include <vector>

#include "sim/cloth/simd.h"

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

/// Groups of eight chains of equally many nodes that share none, for solving one per lane: indices
/// into `chains`, -1 for lanes left empty at a group's end. In the order given, but for chains that
/// fit into the group of one before.
inline std::vector<std::array<int, kLanes8>> PackEights(
    const std::vector<std::span<const int>>& chains, std::size_t node_count) {
  std::vector<std::array<int, kLanes8>> eights;
  std::vector<bool> packed(chains.size(), false);
  for (std::size_t first = 0; first < chains.size(); ++first) {
    if (packed[first]) continue;
    eights.emplace_back().fill(-1);
    std::vector<bool> used(node_count, false);
    std::size_t filled = 0;
    for (std::size_t i = first; i < chains.size() && filled < kLanes8; ++i) {
      if (packed[i] || chains[i].size() != chains[first].size()) continue;
      if (std::ranges::any_of(chains[i], [&](int n) { return used[n]; })) continue;
      packed[i] = true;
      for (const int n : chains[i]) used[n] = true;
      eights.back()[filled++] = static_cast<int>(i);
    }
  }
  return eights;
}

}  // namespace gusset
