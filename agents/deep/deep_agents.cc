#include "agents/deep/deep_agents.h"

#include <ATen/Parallel.h>
#include <dlfcn.h>
#include <torch/csrc/api/include/torch/version.h>

#include <nlohmann/json.hpp>

#include "base/error.h"

namespace gusset {
namespace {

// Sums must not depend on how many cores are free, and networks this small gain nothing from more.
// What multiplies matrices is the machine's libblas.so.3: OpenBLAS, which has threads of its own,
// or another one, which has no such function.
void UseOneThread() {
  at::set_num_threads(1);
  void* symbol = ::dlsym(RTLD_DEFAULT, "openblas_set_num_threads");
  if (symbol != nullptr) reinterpret_cast<void (*)(int)>(symbol)(1);
}

std::string Blas() {
  const auto text = [](const char* function) -> const char* {
    void* symbol = ::dlsym(RTLD_DEFAULT, function);
    return symbol == nullptr ? nullptr : reinterpret_cast<const char* (*)()>(symbol)();
  };
  const char* config = text("openblas_get_config");
  const char* core = text("openblas_get_corename");
  if (config == nullptr || core == nullptr) return "not OpenBLAS";
  // "OpenBLAS 0.3.21 DYNAMIC_ARCH ...": the first two words.
  const std::string all = config;
  return all.substr(0, all.find(' ', all.find(' ') + 1)) + ", " + core;
}

}  // namespace

const char* GussetDeepVersions() {
  static const std::string versions =
      nlohmann::json{{"libtorch", TORCH_VERSION}, {"blas", Blas()}}.dump();
  return versions.c_str();
}

Agent* GussetMakeDeepAgent(const std::string& name, const DeepConfig& config,
                           const std::vector<int>& n_actions) {
  UseOneThread();
  if (name == "a2c") return MakeA2c(config, n_actions).release();
  if (name == "ppo") return MakePpo(config, n_actions).release();
  std::unique_ptr<Agent> agent = MakeDqn(name, config, n_actions);
  if (!agent) throw InputError("no agent is called " + name);
  return agent.release();
}

}  // namespace gusset
