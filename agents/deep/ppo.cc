// Proximal policy optimisation (Schulman et al. 2017), as PPO2 in Stable-Baselines 2.
#include "agents/deep/ppo.h"

#include <numeric>

#include "agents/deep/deep_agents.h"
#include "agents/deep/on_policy.h"
#include "base/error.h"

namespace gusset {
namespace {

class Ppo final : public OnPolicyAgent {
 public:
  Ppo(const DeepConfig& config, const std::vector<int>& n_actions)
      : OnPolicyAgent("ppo", n_actions, config.ppo.n_steps, config.seed), config_(config.ppo) {
    set_optimizer(Optimizer::Adam(config_.learning_rate, 1e-5, parameters()));
  }

 private:
  void Update(const std::vector<Experience>& rollout) override {
    const std::size_t n = rollout.size();
    at::Tensor old_log, old_value, advantages;
    {
      const at::NoGradGuard no_gradients;
      old_log = LogPolicyAt(rollout).gather(1, Actions(rollout).unsqueeze(1)).squeeze(1);
      old_value = ValueAt(rollout, /*after=*/false).contiguous();
      const at::Tensor next = ValueAt(rollout, /*after=*/true).contiguous();
      advantages = at::tensor(
          GeneralisedAdvantages(rollout, {old_value.data_ptr<float>(), n},
                                {next.data_ptr<float>(), n}, config_.gamma, config_.lambda),
          at::kFloat);
    }
    const at::Tensor returns = advantages + old_value;

    Rng rng(DeriveSeed(seed(), "ppo order", static_cast<std::uint64_t>(updates())));
    std::vector<std::int64_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    const std::size_t size = n / static_cast<std::size_t>(config_.minibatches);
    for (int epoch = 0; epoch < config_.epochs; ++epoch) {
      rng.Shuffle(order);
      for (std::size_t start = 0; start < n; start += size) {
        const std::span<const std::int64_t> part(order.data() + start, size);
        std::vector<Experience> batch;
        for (const std::int64_t i : part) batch.push_back(rollout[static_cast<std::size_t>(i)]);
        const at::Tensor index = at::tensor(at::IntArrayRef(part.data(), part.size()), at::kLong);
        at::Tensor a = advantages.index_select(0, index);
        a = (a - a.mean()) / (a.std(/*unbiased=*/false) + 1e-8);
        const at::Tensor loss =
            PpoLoss(LogPolicyAt(batch), Actions(batch), ValueAt(batch, /*after=*/false),
                    old_log.index_select(0, index), old_value.index_select(0, index), a,
                    returns.index_select(0, index), config_);
        std::vector<at::Tensor> gradients = Gradients(loss, parameters());
        ClipTogether(gradients, config_.max_grad_norm);
        optimizer().Step(parameters(), gradients);
      }
    }
  }

  PpoConfig config_;
};

}  // namespace

std::vector<double> GeneralisedAdvantages(std::span<const Experience> rollout,
                                          std::span<const float> values,
                                          std::span<const float> next_values, double gamma,
                                          double lambda) {
  std::vector<double> advantages(rollout.size());
  for (std::size_t i = rollout.size(); i-- > 0;) {
    const Experience& step = rollout[i];
    const bool goes_on = !step.over && i + 1 < rollout.size() && rollout[i + 1].follows;
    const double next = step.over ? 0 : double{goes_on ? values[i + 1] : next_values[i]};
    advantages[i] = double{step.reward} + gamma * next - double{values[i]};
    if (goes_on) advantages[i] += gamma * lambda * advantages[i + 1];
  }
  return advantages;
}

at::Tensor PpoLoss(const at::Tensor& log_policy, const at::Tensor& action, const at::Tensor& value,
                   const at::Tensor& old_log_chosen, const at::Tensor& old_value,
                   const at::Tensor& advantage, const at::Tensor& returns,
                   const PpoConfig& config) {
  const double c = config.clip;
  const at::Tensor ratio =
      (log_policy.gather(1, action.unsqueeze(1)).squeeze(1) - old_log_chosen).exp();
  const at::Tensor policy_loss =
      at::maximum(-advantage * ratio, -advantage * ratio.clamp(1 - c, 1 + c)).mean();
  const at::Tensor clipped_value = old_value + (value - old_value).clamp(-c, c);
  const at::Tensor value_loss =
      0.5 * at::maximum((value - returns).square(), (clipped_value - returns).square()).mean();
  return policy_loss + config.value_coef * value_loss - config.entropy_coef * Entropy(log_policy);
}

std::unique_ptr<Agent> MakePpo(const DeepConfig& config, const std::vector<int>& n_actions) {
  ValidateOrThrow("ppo", config.ppo);
  if (config.ppo.n_steps % config.ppo.minibatches != 0) {
    throw InputError("ppo.minibatches = " + std::to_string(config.ppo.minibatches) +
                     " does not divide ppo.n_steps = " + std::to_string(config.ppo.n_steps));
  }
  return std::make_unique<Ppo>(config, n_actions);
}

}  // namespace gusset
