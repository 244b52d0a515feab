// Advantage actor-critic, the synchronous form of A3C (Mnih et al. 2016) with one actor, as in
// Stable-Baselines 2.
#include "agents/deep/a2c.h"

#include "agents/deep/deep_agents.h"
#include "agents/deep/on_policy.h"

namespace gusset {
namespace {

class A2c final : public OnPolicyAgent {
 public:
  A2c(const DeepConfig& config, const std::vector<int>& n_actions)
      : OnPolicyAgent("a2c", n_actions, config.a2c.n_steps, config.seed), config_(config.a2c) {
    set_optimizer(
        Optimizer::RmsProp(config_.learning_rate, config_.alpha, config_.epsilon, parameters()));
  }

 private:
  void Update(const std::vector<Experience>& rollout) override {
    at::Tensor returns;
    {
      const at::NoGradGuard no_gradients;
      const at::Tensor next = ValueAt(rollout, /*after=*/true).contiguous();
      returns = at::tensor(
          BootstrappedReturns(rollout, {next.data_ptr<float>(), rollout.size()}, config_.gamma),
          at::kFloat);
    }
    std::vector<at::Tensor> gradients =
        Gradients(A2cLoss(LogPolicyAt(rollout), Actions(rollout), ValueAt(rollout, /*after=*/false),
                          returns, config_.value_coef, config_.entropy_coef),
                  parameters());
    ClipTogether(gradients, config_.max_grad_norm);
    optimizer().Step(parameters(), gradients);
  }

  A2cConfig config_;
};

}  // namespace

std::vector<double> BootstrappedReturns(std::span<const Experience> rollout,
                                        std::span<const float> next_values, double gamma) {
  std::vector<double> returns(rollout.size());
  for (std::size_t i = rollout.size(); i-- > 0;) {
    const bool goes_on = i + 1 < rollout.size() && rollout[i + 1].follows;
    const double next = goes_on ? returns[i + 1] : double{next_values[i]};
    returns[i] = double{rollout[i].reward} + (rollout[i].over ? 0 : gamma * next);
  }
  return returns;
}

at::Tensor A2cLoss(const at::Tensor& log_policy, const at::Tensor& action, const at::Tensor& value,
                   const at::Tensor& returns, double value_coef, double entropy_coef) {
  const at::Tensor advantage = returns - value.detach();
  const at::Tensor log_chosen = log_policy.gather(1, action.unsqueeze(1)).squeeze(1);
  return -(advantage * log_chosen).mean() + value_coef * (value - returns).square().mean() -
         entropy_coef * Entropy(log_policy);
}

std::unique_ptr<Agent> MakeA2c(const DeepConfig& config, const std::vector<int>& n_actions) {
  ValidateOrThrow("a2c", config.a2c);
  return std::make_unique<A2c>(config, n_actions);
}

}  // namespace gusset
