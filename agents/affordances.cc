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

int AllActions() {
  int sum = 0;
  for (int s = 0; s < kActingStates; ++s) sum += AffordanceOf(s).actions();
  return sum;
}

int PairOfAction(int index, int& action) {
  assert(index >= 0 && index < AllActions());
  int pair = 0;
  while (index >= AffordanceOf(pair).actions()) index -= AffordanceOf(pair++).actions();
  action = index;
  return pair;
}

std::vector<int> ActionsOnOffer(bool affordances) {
  std::vector<int> counts;
  for (int s = 0; s < kActingStates; ++s) {
    counts.push_back(affordances ? AffordanceOf(s).actions() : AllActions());
  }
  return counts;
}

}  // namespace gusset
