#include "tools/gusset/deep_agents.h"

#include "agents/deep/deep_agents.h"
#include "base/error.h"

#ifdef GUSSET_DEEP_LIBRARY
#include <dlfcn.h>
#endif

namespace gusset {

#ifdef GUSSET_DEEP_LIBRARY
std::unique_ptr<Agent> LoadDeepAgent(const std::string& name, const DeepConfig& config,
                                     const std::vector<int>& n_actions) {
  const auto fail = [&] {
    return InputError("agent '" + name + "' needs its library: " + ::dlerror());
  };
  // Never closed: agents made by it may live until the process ends.
  void* library = ::dlopen(GUSSET_DEEP_LIBRARY, RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw fail();
  void* symbol = ::dlsym(library, kMakeDeepAgentSymbol);
  if (symbol == nullptr) throw fail();
  const auto make = reinterpret_cast<decltype(&GussetMakeDeepAgent)>(symbol);
  return std::unique_ptr<Agent>(make(name, config, n_actions));
}

nlohmann::ordered_json LoadedDeepVersions() {
  void* library = ::dlopen(GUSSET_DEEP_LIBRARY, RTLD_NOW | RTLD_NOLOAD);
  void* symbol = library == nullptr ? nullptr : ::dlsym(library, kDeepVersionsSymbol);
  if (symbol == nullptr) return nlohmann::ordered_json::object();
  return nlohmann::ordered_json::parse(reinterpret_cast<decltype(&GussetDeepVersions)>(symbol)());
}
#else
std::unique_ptr<Agent> LoadDeepAgent(const std::string& name, const DeepConfig&,
                                     const std::vector<int>&) {
  throw InputError("agent '" + name + "' needs a build with libtorch");
}

nlohmann::ordered_json LoadedDeepVersions() { return nlohmann::ordered_json::object(); }
#endif

}  // namespace gusset
