#include "agents/experiment/intervals.h"

#include <cmath>
#include <numbers>
#include <numeric>

namespace gusset {
namespace {

// P(|T| < t), Abramowitz and Stegun 26.7.3 (odd degrees of freedom) and 26.7.4 (even ones).
double WithinT(double t, int freedom) {
  const double theta = std::atan(t / std::sqrt(freedom));
  const double c2 = std::cos(theta) * std::cos(theta);
  const bool odd = freedom % 2 == 1;
  double term = odd ? std::cos(theta) : 1;
  double sum = freedom > 1 ? term : 0;
  for (int k = odd ? 3 : 2; k < freedom; k += 2) {
    term *= c2 * (k - 1) / k;
    sum += term;
  }
  const double series = std::sin(theta) * sum;
  return odd ? 2 / std::numbers::pi * (theta + series) : series;
}

}  // namespace

double StudentT975(int freedom) {
  double lo = 1.9, hi = 12.8;  // infinitely many degrees have 1.960, one has 12.706
  while (hi - lo > 1e-10) {
    const double middle = 0.5 * (lo + hi);
    (WithinT(middle, freedom) < 0.95 ? lo : hi) = middle;
  }
  return 0.5 * (lo + hi);
}

double Mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::optional<std::array<double, 2>> MeanInterval(const std::vector<double>& values) {
  if (values.size() < 2) return std::nullopt;
  const auto n = static_cast<double>(values.size());
  const double mean = Mean(values);
  double squares = 0;
  for (const double x : values) squares += (x - mean) * (x - mean);
  const double half =
      StudentT975(static_cast<int>(values.size()) - 1) * std::sqrt(squares / (n - 1) / n);
  return std::array{mean - half, mean + half};
}

}  // namespace gusset
