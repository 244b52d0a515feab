#include "agents/deep/on_policy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "agents/json_fields.h"
#include "base/error.h"

namespace gusset {
namespace {

// SB2's ActorCriticPolicy: the policy's last layer starts close to uniform.
constexpr double kPolicyGain = 0.01, kValueGain = 1;

Mlp NewNetwork(int inputs, int outputs, double gain, std::uint64_t seed, const char* purpose) {
  Rng rng(DeriveSeed(seed, purpose));
  return Mlp(MlpKind::kTanh, inputs, outputs, gain, rng);
}

}  // namespace

at::Tensor LogPolicy(const at::Tensor& logits, const at::Tensor& allowed) {
  // Not minus infinity, whose product with probability 0 is no number.
  return at::log_softmax(logits.masked_fill(~allowed, -1e9), 1);
}

at::Tensor Entropy(const at::Tensor& log_policy) {
  return -(log_policy.exp() * log_policy).sum(1).mean();
}

OnPolicyAgent::OnPolicyAgent(std::string name, const std::vector<int>& n_actions, int n_steps,
                             std::uint64_t seed)
    : name_(std::move(name)),
      n_actions_(n_actions),
      n_steps_(n_steps),
      seed_(seed),
      mask_(ActionMask(n_actions)),
      policy_(NewNetwork(states() + kSeenFeatures, static_cast<int>(mask_.size(1)), kPolicyGain,
                         seed, "policy weights")),
      value_(NewNetwork(states() + kSeenFeatures, 1, kValueGain, seed, "value weights")),
      optimizer_(Optimizer::Adam(0, 1, {})) {}

std::vector<at::Tensor> OnPolicyAgent::parameters() const {
  std::vector<at::Tensor> all = policy_.parameters();
  all.insert(all.end(), value_.parameters().begin(), value_.parameters().end());
  return all;
}

at::Tensor OnPolicyAgent::LogPolicyAt(std::span<const Experience> experiences) const {
  return LogPolicy(policy_.Forward(Observations(experiences, states(), /*after=*/false)),
                   mask_.index_select(0, States(experiences, /*after=*/false)));
}

at::Tensor OnPolicyAgent::ValueAt(std::span<const Experience> experiences, bool after) const {
  return value_.Forward(Observations(experiences, states(), after)).squeeze(1);
}

Decision OnPolicyAgent::Act(int state, std::span<const double> features, int n_actions, Mode mode,
                            Rng& rng) const {
  const at::NoGradGuard no_gradients;
  const at::Tensor logits = policy_.Forward(Observation(state, features, states()));
  const float* logit = logits.data_ptr<float>();
  const int best = static_cast<int>(std::max_element(logit, logit + n_actions) - logit);
  if (mode == Mode::kGreedy) return {best, false, 0};

  std::vector<double> weights;  // proportional to the probabilities
  double sum = 0;
  for (int a = 0; a < n_actions; ++a) {
    weights.push_back(std::exp(double{logit[a]} - double{logit[best]}));
    sum += weights.back();
  }
  double left = rng.Uniform() * sum;
  int action = 0;
  while (action + 1 < n_actions && left >= weights[static_cast<std::size_t>(action)]) {
    left -= weights[static_cast<std::size_t>(action++)];
  }
  return {action, action != best, 1 - 1 / sum};
}

void OnPolicyAgent::Learn(const Transition& transition) {
  rollout_.push_back(ExperienceOf(transition, states()));
  if (static_cast<int>(rollout_.size()) < n_steps_) return;
  Update(rollout_);
  ++updates_;
  rollout_.clear();
}

nlohmann::json OnPolicyAgent::Save() const {
  return {{"n_actions", n_actions_},
          {"updates", updates_},
          {"policy", SaveTensors(policy_.parameters())},
          {"value", SaveTensors(value_.parameters())},
          {"optimizer", optimizer_.Save()},
          {"rollout", SaveExperiences(rollout_)}};
}

void OnPolicyAgent::Load(const nlohmann::json& saved) {
  if (JsonField<nlohmann::json>(saved, "n_actions") != nlohmann::json(n_actions_)) {
    throw InputError("n_actions is not " + nlohmann::json(n_actions_).dump());
  }
  const int updates = JsonField<int>(saved, "updates", 0, std::numeric_limits<int>::max());
  const Mlp policy = policy_.Clone();
  const Mlp value = value_.Clone();
  LoadTensors(saved, "policy", policy.parameters(), kMostWeight);
  LoadTensors(saved, "value", value.parameters(), kMostWeight);
  Optimizer optimizer = optimizer_.Clone();
  optimizer.Load(JsonField<nlohmann::json>(saved, "optimizer"));
  rollout_ = LoadExperiences(saved, "rollout", n_actions_, static_cast<std::size_t>(n_steps_) - 1);
  updates_ = updates;
  policy_ = policy;
  value_ = value;
  optimizer_ = std::move(optimizer);
}

}  // namespace gusset
