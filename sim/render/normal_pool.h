#pragma once

#include <vector>

#include "base/random.h"

namespace gusset {

/// The longest row, in numbers, that NormalRow gives.
inline constexpr int kMaxNormalRow = 1 << 14;

/// kMaxNormalRow standard normal numbers, of which rows of pixels take as many as they need: a
/// stretch from a random place in a fixed pool. A million fresh ones per frame would take longer
/// than the frame itself. The pool's mean is 0 exactly. Takes one draw from rng.
const float* NormalRow(Rng& rng);

/// The pool itself, and where in it the next row begins: for noise that is scaled and rounded
/// before it is drawn from. Takes one draw from rng.
const std::vector<float>& NormalPool();
int NormalPlace(Rng& rng);

}  // namespace gusset
