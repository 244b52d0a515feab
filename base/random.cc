#include "base/random.h"

#include <cmath>
#include <numbers>

#include "base/fnv1a.h"

namespace gusset {
namespace {

// SplitMix64's finaliser (Steele, Lea, Flood 2014): every input bit reaches every output bit.
std::uint64_t Mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ull;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

}  // namespace

std::uint64_t DeriveSeed(std::uint64_t run_seed, std::string_view purpose, std::uint64_t index) {
  return Mix(Mix(Mix(run_seed) ^ Fnv1a(purpose)) ^ Mix(index));
}

int Rng::Below(int n) {
  // Rejection keeps every value equally likely.
  const std::uint64_t bound = static_cast<std::uint64_t>(n);
  const std::uint64_t limit = ~std::uint64_t{0} - (~std::uint64_t{0} % bound + 1) % bound;
  std::uint64_t draw = engine_();
  while (draw > limit) draw = engine_();
  return static_cast<int>(draw % bound);
}

double Rng::Normal() {
  const double u = 1.0 - Uniform();  // in (0, 1], so that the logarithm is finite
  const double v = Uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace gusset
