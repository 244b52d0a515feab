#include "agents/deep/network.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "agents/deep/a2c.h"
#include "agents/deep/dqn.h"
#include "agents/deep/on_policy.h"
#include "agents/deep/ppo.h"
#include "base/error.h"

namespace gusset {
namespace {

at::Tensor Random(at::IntArrayRef shape, std::uint64_t seed, double lo = -1, double hi = 1) {
  const at::Tensor t = at::empty(shape, at::kDouble);
  Rng rng(seed);
  for (int i = 0; i < t.numel(); ++i) t.data_ptr<double>()[i] = rng.Uniform(lo, hi);
  return t;
}

at::Tensor Numbers(const std::vector<double>& values) { return at::tensor(values, at::kDouble); }

// Every parameter's gradient against (L(x + h) - L(x - h)) / 2h in double precision: off by
// h^2 L'''/6 and by a rounding of some 1e-16 / h, both near 1e-10 with h = 1e-6 and numbers
// about 1.
void ExpectGradientsOfFiniteDifferences(const std::vector<at::Tensor>& parameters,
                                        const std::function<at::Tensor()>& loss) {
  const std::vector<at::Tensor> gradients = Gradients(loss(), parameters);
  constexpr double h = 1e-6;
  double largest = 0;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const at::NoGradGuard no_gradients;
    const std::int64_t stride = std::max<std::int64_t>(1, parameters[p].numel() / 40);
    for (std::int64_t i = 0; i < parameters[p].numel(); i += stride) {
      double& x = parameters[p].data_ptr<double>()[i];
      const double at = x;
      x = at + h;
      const double above = loss().item<double>();
      x = at - h;
      const double below = loss().item<double>();
      x = at;
      const double gradient = gradients[p].contiguous().data_ptr<double>()[i];
      EXPECT_NEAR(gradient, (above - below) / (2 * h), 1e-8) << p << " " << i;
      largest = std::max(largest, std::abs(gradient));
    }
  }
  EXPECT_GT(largest, 1e-3) << "nothing was differentiated";
}

struct Batch {
  at::Tensor x = Random({7, 6}, 1);
  at::Tensor action = at::tensor({0, 3, 2, 1, 3, 0, 2}, at::kLong);
  at::Tensor numbers = Random({7}, 2);
  at::Tensor mask = Random({7, 4}, 3).gt(-2);  // all ...
  Batch() {
    mask.select(0, 0).select(0, 3).fill_(false);  // ... but one
  }
};

TEST(Gradients, OfTheDqnLossAreThoseOfFiniteDifferences) {
  Rng rng(4);
  const Mlp net(MlpKind::kRelu, 6, 4, 0, rng, at::kDouble);
  const Batch b;
  ExpectGradientsOfFiniteDifferences(net.parameters(), [&] {
    return DqnLoss(net.Forward(b.x), b.action, 3 * b.numbers);  // both sides of Huber's threshold
  });
}

TEST(Gradients, OfTheA2cLossAreThoseOfFiniteDifferences) {
  Rng rng(5);
  const Mlp policy(MlpKind::kTanh, 6, 4, 1, rng, at::kDouble);
  const Mlp value(MlpKind::kTanh, 6, 1, 1, rng, at::kDouble);
  const Batch b;
  // The advantage is a number in the loss, so finite differences must not move it either.
  const at::Tensor fixed = value.Forward(b.x).squeeze(1).detach();
  ExpectGradientsOfFiniteDifferences(policy.parameters(), [&] {
    return A2cLoss(LogPolicy(policy.Forward(b.x), b.mask), b.action, fixed, b.numbers, 0.25, 0.1);
  });
  const at::Tensor log_policy = LogPolicy(policy.Forward(b.x), b.mask).detach();
  const double policy_part = A2cLoss(log_policy, b.action, fixed, b.numbers, 0, 0).item<double>();
  ExpectGradientsOfFiniteDifferences(value.parameters(), [&] {
    const at::Tensor v = value.Forward(b.x).squeeze(1);
    return A2cLoss(log_policy, b.action, v, b.numbers, 0.25, 0) -
           A2cLoss(log_policy, b.action, v, b.numbers, 0, 0) + policy_part;
  });
}

TEST(Gradients, OfThePpoLossAreThoseOfFiniteDifferences) {
  Rng rng(6);
  const Mlp policy(MlpKind::kTanh, 6, 4, 1, rng, at::kDouble);
  const Mlp value(MlpKind::kTanh, 6, 1, 1, rng, at::kDouble);
  const Batch b;
  const at::Tensor old_value = Random({7}, 8, -0.4, 0.4);
  const at::Tensor advantage = Random({7}, 9);
  const auto log_policy = [&] { return LogPolicy(policy.Forward(b.x), b.mask); };
  // Some ratios within the clip, some beyond it on either side.
  const at::Tensor old_log =
      log_policy().detach().gather(1, b.action.unsqueeze(1)).squeeze(1) + Random({7}, 10, -.4, .4);
  std::vector<at::Tensor> all = policy.parameters();
  all.insert(all.end(), value.parameters().begin(), value.parameters().end());
  ExpectGradientsOfFiniteDifferences(all, [&] {
    return PpoLoss(log_policy(), b.action, value.Forward(b.x).squeeze(1), old_log, old_value,
                   advantage, b.numbers, {});
  });
}

TEST(Mlp, OrthogonalWeightsAreOrthogonalTimesTheGain) {
  Rng rng(7);
  const Mlp net(MlpKind::kTanh, 6, 4, 0.01, rng, at::kDouble);
  const auto error = [](const at::Tensor& product, double gain) {
    at::Tensor wanted = at::zeros_like(product);
    wanted.diagonal().fill_(gain * gain);
    return (product - wanted).abs().max().item<double>();
  };
  const at::NoGradGuard no_gradients;
  const std::vector<at::Tensor>& p = net.parameters();
  EXPECT_LT(error(p[0].t().mm(p[0]), std::sqrt(2)), 1e-12);  // 64 x 6: columns
  EXPECT_LT(error(p[2].mm(p[2].t()), std::sqrt(2)), 1e-12);
  EXPECT_LT(error(p[4].mm(p[4].t()), 0.01), 1e-12);  // 4 x 64: rows
  for (const std::size_t bias : {1, 3, 5}) EXPECT_EQ(p[bias].abs().max().item<double>(), 0);
}

TEST(Mlp, GlorotsWeightsFillTheirBounds) {
  Rng rng(8);
  const Mlp net(MlpKind::kRelu, 6, 81, 0, rng);
  const double bound = std::sqrt(6.0 / (64 + 64));
  EXPECT_LE(net.parameters()[2].abs().max().item<double>(), bound);
  EXPECT_GE(net.parameters()[2].abs().max().item<double>(), 0.99 * bound);
  EXPECT_NEAR(net.parameters()[2].detach().mean().item<double>(), 0,
              5 * bound / std::sqrt(3 * 4096));
}

TEST(Mlp, AClonesWeightsAreItsOwn) {
  Rng rng(9);
  const Mlp net(MlpKind::kRelu, 3, 2, 0, rng);
  const Mlp copy = net.Clone();
  const at::NoGradGuard no_gradients;
  net.parameters()[0].fill_(1);
  EXPECT_NE(copy.parameters()[0].max().item<float>(), 1);
}

// Under a constant gradient g both means are exact: m = (1 - b1^t) g, v = (1 - b2^t) g^2, so that
// every step is lr g / |g|, but for epsilon.
TEST(Optimizer, AdamUnderAConstantGradientMovesByTheLearningRate) {
  const std::vector<at::Tensor> x = {Numbers({1, 2, 3})};
  const std::vector<at::Tensor> g = {Numbers({0.5, -3, 1e-3})};
  Optimizer adam = Optimizer::Adam(0.01, 1e-12, x);
  for (int i = 0; i < 20; ++i) adam.Step(x, g);
  const at::Tensor wanted = Numbers({1 - 0.2, 2 + 0.2, 3 - 0.2});
  EXPECT_LT((x[0] - wanted).abs().max().item<double>(), 1e-7);
}

// v = a^t + (1 - a^t) g^2, since it starts at 1.
TEST(Optimizer, RmsPropUnderAConstantGradientHasItsClosedForm) {
  const std::vector<at::Tensor> x = {Numbers({1})};
  const std::vector<at::Tensor> g = {Numbers({0.3})};
  Optimizer rms = Optimizer::RmsProp(0.01, 0.9, 1e-5, x);
  double wanted = 1;
  for (int t = 1; t <= 20; ++t) {
    rms.Step(x, g);
    const double v = std::pow(0.9, t) + (1 - std::pow(0.9, t)) * 0.09;
    wanted -= 0.01 * 0.3 / std::sqrt(v + 1e-5);
  }
  EXPECT_NEAR(x[0].item<double>(), wanted, 1e-12);
}

TEST(Clip, BringsTheNormDownToItsBoundAndLeavesSmallOnesAlone) {
  const auto three_four = [] { return std::vector<at::Tensor>{Numbers({3}), Numbers({0, 4})}; };
  std::vector<at::Tensor> g = three_four();
  ClipTogether(g, 1);
  EXPECT_NEAR(g[0].item<double>(), 0.6, 1e-15);
  EXPECT_NEAR(g[1][1].item<double>(), 0.8, 1e-15);
  g = three_four();
  ClipTogether(g, 6);
  EXPECT_EQ(g[1][1].item<double>(), 4);
  g = three_four();
  ClipEach(g, 3.5);
  EXPECT_EQ(g[0].item<double>(), 3);
  EXPECT_NEAR(g[1][1].item<double>(), 3.5, 1e-15);
}

TEST(Tensors, ComeBackFromTextBitForBit) {
  for (const std::int64_t size : {0, 1, 2, 3, 4, 100}) {  // all three paddings of base64
    const at::Tensor out = Random({size}, 11, -1e9, 1e9).to(at::kFloat) * 1e-20;
    const at::Tensor in = at::empty({size}, at::kFloat);
    const nlohmann::json saved = {{"w", SaveTensors({out})}};
    LoadTensors(nlohmann::json::parse(saved.dump()), "w", {in});
    EXPECT_EQ(std::memcmp(out.data_ptr(), in.data_ptr(), out.nbytes()), 0) << size;
  }
}

TEST(Tensors, AreWrittenAsBase64OfLittleEndianFloats) {
  EXPECT_EQ(SaveTensors({at::tensor({1.0f, -2.0f}, at::kFloat)})[0]["float32"], "AACAPwAAAMA=");
}

TEST(Tensors, DamagedTextIsRefusedByName) {
  const at::Tensor w = at::zeros({2}, at::kFloat);
  const auto error = [&](const nlohmann::json& tensor) -> std::string {
    try {
      LoadTensors({{"w", {tensor}}}, "w", {w});
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  const std::string good = "AACAPwAAAMA=";
  EXPECT_EQ(error({{"shape", {2}}, {"float32", good}}), "");
  EXPECT_THAT(error({{"shape", {3}}, {"float32", good}}), testing::HasSubstr("w[0]"));
  for (const char* bad :
       {"", "AACAPwAAAMA", "AACAPwAAAM==", "AACAPwAA*MA=", "AACAPwAAAMAA", "AACAPwAAAMA=AAAA"}) {
    EXPECT_THAT(error({{"shape", {2}}, {"float32", bad}}), testing::HasSubstr("base64")) << bad;
  }
  for (const char* bad : {"AACAfwAAAMA=", "AADAfwAAAMA=", "5rFhfwAAAMA="}) {  // infinity, NaN, 3e38
    EXPECT_THAT(error({{"shape", {2}}, {"float32", bad}}), testing::HasSubstr("not within +-1"))
        << bad;
  }
  EXPECT_NE(error({{"shape", {2}}}), "");
  EXPECT_NE(error(7), "");
}

}  // namespace
}  // namespace gusset
