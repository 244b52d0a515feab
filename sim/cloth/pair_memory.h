#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace gusset {

/// A number for each of some pairs of elements, to be found again when contacts are selected anew
/// and have other places.
class PairMemory {
 public:
  void Clear() { noted_.clear(); }
  /// @param pair a name that is the same at each selection.
  void Note(std::uint64_t pair, float value) { noted_.push_back({pair, value}); }
  /// After all are noted, before any is sought.
  void Sort() { std::ranges::sort(noted_, {}, &Entry::pair); }
  float Find(std::uint64_t pair, float otherwise) const {
    const auto at = std::ranges::lower_bound(noted_, pair, {}, &Entry::pair);
    return at != noted_.end() && at->pair == pair ? at->value : otherwise;
  }

 private:
  struct Entry {
    std::uint64_t pair;
    float value;
  };
  std::vector<Entry> noted_;
};

}  // namespace gusset
