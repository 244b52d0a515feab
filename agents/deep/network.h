#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "agents/deep/aten.h"
#include "base/random.h"

namespace gusset {

/// How a network is built; both are Stable-Baselines 2's, with two hidden layers of 64.
enum class MlpKind {
  kRelu,  ///< ReLU; weights uniform after Glorot and Bengio (2010), Eq. 16.
  kTanh,  ///< tanh; orthogonal weights (Saxe et al. 2014), gain sqrt(2), the last layer's given.
};

/// A fully connected network, y = W3 act(W2 act(W1 x + b1) + b2) + b3, biases 0 at first.
class Mlp {
 public:
  /// @param head_gain of the last layer's orthogonal weights; kRelu does not use it.
  /// @param rng where the weights come from, so that they are the same for any libtorch.
  /// @param type of all numbers: at::kFloat, or at::kDouble where tests differentiate.
  Mlp(MlpKind kind, int inputs, int outputs, double head_gain, Rng& rng,
      at::ScalarType type = at::kFloat);

  /// @param x (batch, inputs). @returns (batch, outputs).
  at::Tensor Forward(const at::Tensor& x) const;
  /// W1, b1, W2, b2, W3, b3; they require gradients.
  const std::vector<at::Tensor>& parameters() const { return parameters_; }
  /// A network of the same weights that shares no memory with this one.
  Mlp Clone() const;

 private:
  MlpKind kind_;
  std::vector<at::Tensor> parameters_;
};

/// Gradient of a loss in each parameter; zeros where the loss does not depend on it.
std::vector<at::Tensor> Gradients(const at::Tensor& loss, const std::vector<at::Tensor>& in);

/// Scales all gradients alike so that their common norm is at most `max_norm`.
void ClipTogether(std::vector<at::Tensor>& gradients, double max_norm);
/// Scales each gradient so that its own norm is at most `max_norm`.
void ClipEach(std::vector<at::Tensor>& gradients, double max_norm);

/// Gradient descent with memory: one or more tensors ("slots") for each parameter.
class Optimizer {
 public:
  /// Adam (Kingma and Ba 2015) as TensorFlow 1 has it, beta1 = 0.9, beta2 = 0.999:
  /// theta -= lr sqrt(1 - beta2^t) / (1 - beta1^t) m / (sqrt(v) + epsilon).
  static Optimizer Adam(double learning_rate, double epsilon,
                        const std::vector<at::Tensor>& parameters);
  /// RMSProp (Tieleman and Hinton 2012) as TensorFlow 1 has it, with v = 1 at first:
  /// v = alpha v + (1 - alpha) g^2; theta -= lr g / sqrt(v + epsilon).
  static Optimizer RmsProp(double learning_rate, double alpha, double epsilon,
                           const std::vector<at::Tensor>& parameters);

  /// One step down; parameters in the order that they had when this was made.
  void Step(const std::vector<at::Tensor>& parameters, const std::vector<at::Tensor>& gradients);

  /// An optimiser in the same state that shares no memory with this one.
  Optimizer Clone() const;
  nlohmann::json Save() const;
  /// @throws InputError; the optimiser is then unusable.
  void Load(const nlohmann::json& saved);

 private:
  Optimizer() = default;
  bool adam_ = true;
  double learning_rate_ = 0, alpha_ = 0, epsilon_ = 0;
  int steps_ = 0;
  std::vector<at::Tensor> first_, second_;  // means of g (Adam alone) and of g^2
};

/// Every tensor as {"shape", "float32": base64 of its numbers, little-endian}.
nlohmann::json SaveTensors(const std::vector<at::Tensor>& tensors);
/// Bound of a weight that is loaded: three layers of larger ones overflow.
constexpr double kMostWeight = 1e6;
/// Copies what `saved` holds under `key` into `tensors`.
/// @param most  bound of every number; by default what squares of gradients may come to.
/// @throws InputError naming the key unless number, shapes and data fit and all is within bounds.
void LoadTensors(const nlohmann::json& saved, const std::string& key,
                 const std::vector<at::Tensor>& tensors, double most = 1e12);

}  // namespace gusset
