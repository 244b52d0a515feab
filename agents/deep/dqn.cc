// Deep Q-learning (Mnih et al. 2015) with the parts that Stable-Baselines 2 adds by default: double
// Q-learning (van Hasselt et al. 2016) and a dueling network (Wang et al. 2016).
#include "agents/deep/dqn.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "agents/deep/deep_agents.h"
#include "agents/deep/experience.h"
#include "agents/deep/network.h"
#include "agents/json_fields.h"
#include "base/error.h"

namespace gusset {
namespace {

struct Variant {
  bool double_q;
  bool dueling;
};

// "dqn" is what `DQN("MlpPolicy", env)` is in Stable-Baselines 2.
std::optional<Variant> VariantOf(const std::string& name) {
  if (name == "dqn") return Variant{true, true};
  if (name == "plain_dqn") return Variant{false, false};
  if (name == "double_dqn") return Variant{true, false};
  if (name == "dueling_dqn") return Variant{false, true};
  return std::nullopt;
}

// Q(s, .) = A(s, .), or if dueling V(s) + A(s, .) - the mean of A(s, .) (Wang et al., Eq. 9).
struct QNetwork {
  Mlp advantage;
  std::optional<Mlp> value;

  QNetwork(bool dueling, int inputs, int actions, Rng& rng)
      : advantage(MlpKind::kRelu, inputs, actions, 0, rng) {
    if (dueling) value.emplace(MlpKind::kRelu, inputs, 1, 0, rng);
  }
  at::Tensor Forward(const at::Tensor& x) const {
    const at::Tensor a = advantage.Forward(x);
    return value ? value->Forward(x) + a - a.mean(1, /*keepdim=*/true) : a;
  }
  std::vector<at::Tensor> parameters() const {
    std::vector<at::Tensor> all = advantage.parameters();
    if (value) all.insert(all.end(), value->parameters().begin(), value->parameters().end());
    return all;
  }
  QNetwork Clone() const {
    QNetwork copy = *this;
    copy.advantage = advantage.Clone();
    if (value) copy.value = value->Clone();
    return copy;
  }
};

class Dqn final : public Agent {
 public:
  Dqn(const std::string& name, Variant variant, const DeepConfig& config,
      const std::vector<int>& n_actions)
      : name_(name),
        variant_(variant),
        config_(config.dqn),
        total_steps_(config.total_steps),
        seed_(config.seed),
        n_actions_(n_actions),
        mask_(ActionMask(n_actions)),
        online_(NewNetwork()),
        target_(online_.Clone()),
        adam_(Optimizer::Adam(config_.learning_rate, 1e-8, online_.parameters())) {}

  Decision Act(int state, std::span<const double> features, int n_actions, Mode mode,
               Rng& rng) const override {
    const double epsilon = mode == Mode::kExplore ? Epsilon() : 0;
    if (mode == Mode::kExplore && rng.Uniform() < epsilon) {
      return {rng.Below(n_actions), true, epsilon};
    }
    const at::NoGradGuard no_gradients;
    const at::Tensor q = online_.Forward(Observation(state, features, states()));
    const float* values = q.data_ptr<float>();
    return {static_cast<int>(std::max_element(values, values + n_actions) - values), false,
            epsilon};
  }

  void Learn(const Transition& transition) override {
    const Experience experience = ExperienceOf(transition, states());
    const auto capacity = static_cast<std::size_t>(config_.buffer_size);
    if (memory_.size() < capacity) {
      memory_.push_back(experience);
    } else {
      memory_[static_cast<std::size_t>(steps_) % capacity] = experience;
    }
    const int step = steps_++;
    if (step <= config_.learning_starts) return;
    const bool enough = memory_.size() >= static_cast<std::size_t>(config_.batch_size);
    if (enough && step % config_.train_freq == 0) Update(step);
    if (step % config_.target_update == 0) target_ = online_.Clone();
  }

  nlohmann::json Save() const override {
    return {{"n_actions", n_actions_},
            {"steps", steps_},
            {"updates", updates_},
            {"online", SaveTensors(online_.parameters())},
            {"target", SaveTensors(target_.parameters())},
            {"adam", adam_.Save()},
            {"memory", SaveExperiences(memory_)}};
  }

  void Load(const nlohmann::json& saved) override {
    Dqn loaded = *this;
    loaded.online_ = online_.Clone();
    loaded.target_ = target_.Clone();
    loaded.adam_ = adam_.Clone();
    if (JsonField<nlohmann::json>(saved, "n_actions") != nlohmann::json(n_actions_)) {
      throw InputError("n_actions is not " + nlohmann::json(n_actions_).dump());
    }
    loaded.steps_ = JsonField<int>(saved, "steps", 0, std::numeric_limits<int>::max());
    loaded.updates_ = JsonField<int>(saved, "updates", 0, loaded.steps_);
    LoadTensors(saved, "online", loaded.online_.parameters(), kMostWeight);
    LoadTensors(saved, "target", loaded.target_.parameters(), kMostWeight);
    loaded.adam_.Load(JsonField<nlohmann::json>(saved, "adam"));
    loaded.memory_ =
        LoadExperiences(saved, "memory", n_actions_, static_cast<std::size_t>(config_.buffer_size));
    if (static_cast<int>(loaded.memory_.size()) != std::min(loaded.steps_, config_.buffer_size)) {
      throw InputError("memory does not hold the last steps, of which there are " +
                       std::to_string(loaded.steps_));
    }
    *this = std::move(loaded);
  }

  std::string name() const override { return name_; }

 private:
  int states() const { return static_cast<int>(n_actions_.size()); }

  QNetwork NewNetwork() const {
    Rng rng(DeriveSeed(seed_, "dqn weights"));
    return {variant_.dueling, states() + kSeenFeatures, static_cast<int>(mask_.size(1)), rng};
  }

  // Falls linearly over the first exploration_fraction of the run.
  double Epsilon() const {
    const double fall =
        std::floor(config_.exploration_fraction * static_cast<double>(total_steps_));
    const double done = fall > 0 ? std::min(steps_ / fall, 1.0) : 1.0;
    return config_.exploration_initial +
           done * (config_.exploration_final - config_.exploration_initial);
  }

  void Update(int step) {
    Rng rng(DeriveSeed(seed_, "dqn batch", static_cast<std::uint64_t>(step)));
    std::vector<Experience> batch;
    for (int i = 0; i < config_.batch_size; ++i) {
      batch.push_back(
          memory_[static_cast<std::size_t>(rng.Below(static_cast<int>(memory_.size())))]);
    }
    at::Tensor targets;
    {
      const at::NoGradGuard no_gradients;
      const at::Tensor next = Observations(batch, states(), /*after=*/true);
      targets = DqnTargets(target_.Forward(next), online_.Forward(next),
                           mask_.index_select(0, States(batch, /*after=*/true)), Rewards(batch),
                           GoesOn(batch), config_.gamma, variant_.double_q);
    }
    const at::Tensor q = online_.Forward(Observations(batch, states(), /*after=*/false));
    const std::vector<at::Tensor> parameters = online_.parameters();
    std::vector<at::Tensor> gradients = Gradients(DqnLoss(q, Actions(batch), targets), parameters);
    ClipEach(gradients, config_.max_grad_norm);
    adam_.Step(parameters, gradients);
    ++updates_;
  }

  std::string name_;
  Variant variant_;
  DqnConfig config_;
  std::int64_t total_steps_;
  std::uint64_t seed_;
  std::vector<int> n_actions_;
  at::Tensor mask_;
  QNetwork online_, target_;
  Optimizer adam_;  // epsilon 1e-8: TensorFlow's default
  std::vector<Experience> memory_;
  int steps_ = 0;
  int updates_ = 0;
};

}  // namespace

at::Tensor DqnTargets(const at::Tensor& next_target, const at::Tensor& next_online,
                      const at::Tensor& allowed, const at::Tensor& reward,
                      const at::Tensor& goes_on, double gamma, bool double_q) {
  const at::NoGradGuard no_gradients;
  const at::Tensor judge = double_q ? next_online : next_target;
  const at::Tensor chosen =
      judge.masked_fill(~allowed, -std::numeric_limits<double>::infinity()).argmax(1, true);
  return reward + gamma * goes_on * next_target.gather(1, chosen).squeeze(1);
}

at::Tensor DqnLoss(const at::Tensor& q, const at::Tensor& action, const at::Tensor& target) {
  return at::huber_loss(q.gather(1, action.unsqueeze(1)).squeeze(1), target);
}

std::unique_ptr<Agent> MakeDqn(const std::string& name, const DeepConfig& config,
                               const std::vector<int>& n_actions) {
  const std::optional<Variant> variant = VariantOf(name);
  if (!variant) return nullptr;
  ValidateOrThrow("dqn", config.dqn);
  return std::make_unique<Dqn>(name, *variant, config, n_actions);
}

}  // namespace gusset
