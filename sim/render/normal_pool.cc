#include "sim/render/normal_pool.h"

#include <utility>
#include <vector>

namespace gusset {
namespace {

constexpr int kPoolSize = 1 << 18;

}  // namespace

const std::vector<float>& NormalPool() {
  static const std::vector<float> pool = [] {
    Rng rng(DeriveSeed(1, "normal pool"));
    std::vector<float> values(kPoolSize);
    // In pairs of opposite sign: the mean is 0 exactly.
    for (std::size_t i = 0; i < values.size(); i += 2) {
      values[i] = static_cast<float>(rng.Normal());
      values[i + 1] = -values[i];
    }
    // Neighbours in a row must not be each other's mirror image.
    for (int i = kPoolSize - 1; i > 0; --i) std::swap(values[i], values[rng.Below(i + 1)]);
    // Ends with a copy of its beginning, so that a row may start anywhere.
    for (int i = 0; i < kMaxNormalRow; ++i) values.push_back(values[i]);
    return values;
  }();
  return pool;
}

int NormalPlace(Rng& rng) { return rng.Below(kPoolSize); }

const float* NormalRow(Rng& rng) { return NormalPool().data() + NormalPlace(rng); }

}  // namespace gusset
