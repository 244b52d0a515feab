#include "agents/deep/deep_agents.h"

#include <ATen/Parallel.h>
#include <dlfcn.h>

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

}  // namespace

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
