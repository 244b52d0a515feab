#include "agents/thompson_sampling.h"

#include <cassert>
#include <cmath>

#include "agents/bandit_rewards.h"
#include "agents/json_fields.h"

namespace gusset {
namespace {

// Gamma distribution of scale 1 and shape >= 1 by rejection (Marsaglia and Tsang 2000, section 2).
double DrawGamma(double shape, Rng& rng) {
  const double d = shape - 1.0 / 3;
  const double c = 1 / std::sqrt(9 * d);
  for (;;) {
    const double x = rng.Normal();
    const double v = std::pow(1 + c * x, 3);
    const double u = 1 - rng.Uniform();  // in (0, 1]
    if (v > 0 && std::log(u) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v;
  }
}

}  // namespace

double DrawBeta(double a, double b, Rng& rng) {
  const double x = DrawGamma(a, rng);
  return x / (x + DrawGamma(b, rng));
}

Decision ThompsonSampling::Act(int state, std::span<const double>, int n_actions, Mode mode,
                               Rng& rng) const {
  assert(n_actions == table_.actions(state));
  const int best = table_.best(state);
  if (mode == Mode::kGreedy) return {best, false, 0};
  std::vector<double> drawn;
  for (int a = 0; a < n_actions; ++a) {
    const ActionTable::Entry& entry = table_.at(state, a);
    const double n = entry.count;
    drawn.push_back(DrawBeta(1 + n * entry.value, 1 + n * (1 - entry.value), rng));
  }
  const int action = DrawHighest(drawn, rng);
  return {action, action != best, 0};
}

void ThompsonSampling::Learn(const Transition& t) {
  ActionTable::Entry& entry = table_.Count(t.state, t.action);
  entry.value += (UnitReward(t.reward) - entry.value) / entry.count;
}

nlohmann::json ThompsonSampling::Save() const { return {{"states", table_.Save()}}; }

void ThompsonSampling::Load(const nlohmann::json& saved) {
  table_ = ActionTable::Load(saved, table_.ActionCounts(), 0, 1);
}

}  // namespace gusset
