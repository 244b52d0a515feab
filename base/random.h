#pragma once

#include <cstdint>
#include <random>
#include <string_view>
#include <utility>
#include <vector>

namespace gusset {

/// Derives an independent seed from a run's seed, what it is for and an index. Depends on nothing
/// else, so no draw anywhere can shift another purpose's stream.
std::uint64_t DeriveSeed(std::uint64_t run_seed, std::string_view purpose, std::uint64_t index = 0);

/// Random numbers that are the same on every standard library: std::mt19937_64 is fixed by the
/// standard, the std distributions are not, so the distributions are spelled out here.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : engine_(seed) {}
  /// Uniform on [0, 1), 53 bits.
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  /// Uniform on [lo, hi).
  double Uniform(double lo, double hi) { return lo + (hi - lo) * Uniform(); }
  /// Uniform integer in [0, n); n >= 1.
  int Below(int n);
  /// Puts the items in random order, every order equally likely (Fisher and Yates).
  template <class T>
  void Shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) {
      std::swap(items[i - 1], items[static_cast<std::size_t>(Below(static_cast<int>(i)))]);
    }
  }
  /// Standard normal, by Box and Muller (1958), one of the pair.
  double Normal();
  std::uint64_t Bits() { return engine_(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace gusset
