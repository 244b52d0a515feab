#include "agents/deep/network.h"

#include <Eigen/QR>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>

#include "agents/json_fields.h"
#include "base/error.h"

namespace gusset {
namespace {

constexpr int kHidden = 64;  // SB2's MlpPolicy: layers = [64, 64]
constexpr double kBeta1 = 0.9, kBeta2 = 0.999;

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Matrix GlorotUniform(int rows, int cols, Rng& rng) {
  const double bound = std::sqrt(6.0 / (rows + cols));
  Matrix weights(rows, cols);
  for (double& w : weights.reshaped<Eigen::RowMajor>()) w = rng.Uniform(-bound, bound);
  return weights;
}

// Q of a normal matrix's QR, columns signed by R's diagonal: uniform among orthogonal matrices
// (Mezzadri 2007).
Matrix Orthogonal(int rows, int cols, double gain, Rng& rng) {
  const int tall = std::max(rows, cols), flat = std::min(rows, cols);
  Eigen::MatrixXd normal(tall, flat);
  for (double& x : normal.reshaped()) x = rng.Normal();
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(normal);
  Eigen::MatrixXd q = qr.householderQ() * Eigen::MatrixXd::Identity(tall, flat);
  for (int i = 0; i < flat; ++i) {
    if (qr.matrixQR()(i, i) < 0) q.col(i) *= -1;
  }
  q *= gain;
  return rows == tall ? Matrix(q) : Matrix(q.transpose());
}

at::Tensor Parameter(const Matrix& values, at::ScalarType type) {
  const at::Tensor view = at::from_blob(const_cast<double*>(values.data()),
                                        {values.rows(), values.cols()}, at::kDouble);
  return view.to(type, /*non_blocking=*/false, /*copy=*/true).set_requires_grad(true);
}

// ---- base64 (RFC 4648), for weights in JSON

constexpr char kAlphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

std::string ToBase64(const unsigned char* bytes, std::size_t size) {
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k) group = group << 8 | (i + k < size ? bytes[i + k] : 0u);
    for (std::size_t k = 0; k < 4; ++k) {
      text += i + k <= size ? kAlphabet[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

// @returns false unless `text` is the base64 of exactly `size` bytes.
bool FromBase64(const std::string& text, unsigned char* bytes, std::size_t size) {
  static const auto kValues = [] {
    std::array<int, 256> values;
    values.fill(-1);
    for (int i = 0; i < 64; ++i) values[static_cast<unsigned char>(kAlphabet[i])] = i;
    return values;
  }();
  if (text.size() != (size + 2) / 3 * 4) return false;
  for (std::size_t i = 0; i < size; i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const char c = text[i / 3 * 4 + k];
      const bool padding = i + k > size;
      const int value = kValues[static_cast<unsigned char>(c)];
      if (padding ? c != '=' : value < 0) return false;
      group = group << 6 | static_cast<unsigned>(padding ? 0 : value);
    }
    for (std::size_t k = 0; k < 3 && i + k < size; ++k) bytes[i + k] = group >> (16 - 8 * k) & 255;
  }
  return true;
}

// Agents are asked from several threads, and several may learn at once. Not every BLAS stands that:
// Debian's serial OpenBLAS 0.3.21 gave wrong products in one run of six with three threads.
std::mutex& OneAtATime() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

Mlp::Mlp(MlpKind kind, int inputs, int outputs, double head_gain, Rng& rng, at::ScalarType type)
    : kind_(kind) {
  const std::array<int, 4> sizes = {inputs, kHidden, kHidden, outputs};
  for (std::size_t i = 0; i + 1 < sizes.size(); ++i) {
    const double gain = i + 2 < sizes.size() ? std::sqrt(2.0) : head_gain;
    parameters_.push_back(Parameter(kind == MlpKind::kRelu
                                        ? GlorotUniform(sizes[i + 1], sizes[i], rng)
                                        : Orthogonal(sizes[i + 1], sizes[i], gain, rng),
                                    type));
    parameters_.push_back(at::zeros({sizes[i + 1]}, type).set_requires_grad(true));
  }
}

at::Tensor Mlp::Forward(const at::Tensor& x) const {
  const std::lock_guard lock(OneAtATime());
  at::Tensor y = x;
  for (std::size_t i = 0; i < parameters_.size(); i += 2) {
    y = at::linear(y, parameters_[i], parameters_[i + 1]);
    if (i + 2 < parameters_.size()) y = kind_ == MlpKind::kRelu ? at::relu(y) : at::tanh(y);
  }
  return y;
}

Mlp Mlp::Clone() const {
  Mlp copy = *this;
  for (at::Tensor& p : copy.parameters_) p = p.detach().clone().set_requires_grad(true);
  return copy;
}

std::vector<at::Tensor> Gradients(const at::Tensor& loss, const std::vector<at::Tensor>& in) {
  for (const at::Tensor& p : in) p.mutable_grad().reset();
  {
    const std::lock_guard lock(OneAtATime());
    loss.backward();
  }
  std::vector<at::Tensor> gradients;
  for (const at::Tensor& p : in) {
    gradients.push_back(p.grad().defined() ? p.grad().clone() : at::zeros_like(p.detach()));
    p.mutable_grad().reset();
  }
  return gradients;
}

void ClipTogether(std::vector<at::Tensor>& gradients, double max_norm) {
  double squares = 0;
  for (const at::Tensor& g : gradients) squares += g.square().sum().item<double>();
  const double norm = std::sqrt(squares);
  for (at::Tensor& g : gradients) g.mul_(max_norm / std::max(norm, max_norm));
}

void ClipEach(std::vector<at::Tensor>& gradients, double max_norm) {
  for (at::Tensor& g : gradients) {
    g.mul_(max_norm / std::max(g.norm().item<double>(), max_norm));
  }
}

Optimizer Optimizer::Adam(double learning_rate, double epsilon,
                          const std::vector<at::Tensor>& parameters) {
  Optimizer made;
  made.learning_rate_ = learning_rate;
  made.epsilon_ = epsilon;
  for (const at::Tensor& p : parameters) {
    made.first_.push_back(at::zeros_like(p.detach()));
    made.second_.push_back(at::zeros_like(p.detach()));
  }
  return made;
}

Optimizer Optimizer::RmsProp(double learning_rate, double alpha, double epsilon,
                             const std::vector<at::Tensor>& parameters) {
  Optimizer made;
  made.adam_ = false;
  made.learning_rate_ = learning_rate;
  made.alpha_ = alpha;
  made.epsilon_ = epsilon;
  for (const at::Tensor& p : parameters) made.second_.push_back(at::ones_like(p.detach()));
  return made;
}

void Optimizer::Step(const std::vector<at::Tensor>& parameters,
                     const std::vector<at::Tensor>& gradients) {
  const at::NoGradGuard no_gradients;
  ++steps_;
  const double rate = adam_ ? learning_rate_ * std::sqrt(1 - std::pow(kBeta2, steps_)) /
                                  (1 - std::pow(kBeta1, steps_))
                            : learning_rate_;
  const double decay = adam_ ? kBeta2 : alpha_;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const at::Tensor& g = gradients[i];
    const at::Tensor& v = second_[i];
    v.mul_(decay).addcmul_(g, g, 1 - decay);
    if (adam_) {
      first_[i].mul_(kBeta1).add_(g, 1 - kBeta1);
      parameters[i].addcdiv_(first_[i], v.sqrt().add_(epsilon_), -rate);
    } else {
      parameters[i].addcdiv_(g, at::sqrt(v + epsilon_), -rate);
    }
  }
}

Optimizer Optimizer::Clone() const {
  Optimizer copy = *this;
  for (at::Tensor& m : copy.first_) m = m.clone();
  for (at::Tensor& v : copy.second_) v = v.clone();
  return copy;
}

nlohmann::json Optimizer::Save() const {
  return {{"steps", steps_}, {"first", SaveTensors(first_)}, {"second", SaveTensors(second_)}};
}

void Optimizer::Load(const nlohmann::json& saved) {
  steps_ = JsonField<int>(saved, "steps", 0, std::numeric_limits<int>::max());
  LoadTensors(saved, "first", first_);
  LoadTensors(saved, "second", second_);
  for (const at::Tensor& v : second_) {
    if (v.numel() > 0 && v.min().item<double>() < 0) {
      throw InputError("second has a negative mean of squares");
    }
  }
}

nlohmann::json SaveTensors(const std::vector<at::Tensor>& tensors) {
  nlohmann::json saved = nlohmann::json::array();
  for (const at::Tensor& tensor : tensors) {
    const at::Tensor plain = tensor.detach().to(at::kFloat).contiguous();
    saved.push_back({{"shape", plain.sizes().vec()},
                     {"float32", ToBase64(static_cast<const unsigned char*>(plain.data_ptr()),
                                          static_cast<std::size_t>(plain.nbytes()))}});
  }
  return saved;
}

void LoadTensors(const nlohmann::json& saved, const std::string& key,
                 const std::vector<at::Tensor>& tensors, double most) {
  const auto list = JsonField<nlohmann::json::array_t>(saved, key);
  if (list.size() != tensors.size()) {
    throw InputError(key + " has " + std::to_string(list.size()) + " tensors, not " +
                     std::to_string(tensors.size()));
  }
  const at::NoGradGuard no_gradients;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string place = key + "[" + std::to_string(i) + "]";
    const nlohmann::json wanted = tensors[i].sizes().vec();
    if (!list[i].is_object() || list[i].value("shape", nlohmann::json()) != wanted) {
      throw InputError(place + " is not of shape " + wanted.dump());
    }
    const at::Tensor plain = at::empty(tensors[i].sizes(), at::kFloat);
    if (!FromBase64(JsonField<std::string>(list[i], "float32"),
                    static_cast<unsigned char*>(plain.data_ptr()),
                    static_cast<std::size_t>(plain.nbytes()))) {
      throw InputError(place + " is not base64 of " + std::to_string(plain.numel()) + " numbers");
    }
    // A negated comparison, so that NaN is refused too.
    if (!(plain.abs() <= most).all().item<bool>()) {
      throw InputError(place + " has a number that is not within +-" + nlohmann::json(most).dump());
    }
    tensors[i].copy_(plain);
  }
}

}  // namespace gusset
