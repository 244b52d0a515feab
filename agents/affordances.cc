#include "agents/affordances.h"

#include <array>
#include <cassert>

namespace gusset {

const Affordance& AffordanceOf(int state) {
  static constexpr std::array<Affordance, kActingStates> kPsi = {{
      {"grasp", "lift", kPosePoints, 9},
      {"scratch", "drag", kPosePoints, kPosePoints},
      {"pick", "place", kPosePoints, 1},
      {"close", "carry", 81, 1},
  }};
  assert(state >= 0 && state < kActingStates);
  return kPsi[static_cast<std::size_t>(state)];
}

ActionChoice DecodeAction(int state, int action) {
  const Affordance& rule = AffordanceOf(state);
  assert(action >= 0 && action < rule.actions());
  return {action / rule.parameters, action % rule.parameters};
}

}  // namespace gusset
