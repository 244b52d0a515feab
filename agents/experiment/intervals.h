#pragma once

#include <array>
#include <optional>
#include <vector>

namespace gusset {

/// The 97.5 % point of Student's t with `freedom` degrees of freedom (at least 1), to 1e-9.
/// Abramowitz and Stegun 26.7.3 and 26.7.4, inverted by bisection.
double StudentT975(int freedom);

double Mean(const std::vector<double>& values);

/// 95 % interval of a mean by Student's t, for independent values such as those of several seeds.
/// Nothing for fewer than two values.
std::optional<std::array<double, 2>> MeanInterval(const std::vector<double>& values);

}  // namespace gusset
