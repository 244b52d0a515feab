#pragma once

#include <vector>

namespace gusset {

/// States in which the robot acts, s0 to s3; s4 and s5 end an episode.
inline constexpr int kActingStates = 4;
/// Grid of pose points in s0 to s2: zeta = 3, so zeta^2 = 9 (section 5.3.1).
inline constexpr int kPosePoints = 9;

/// One rule of Psi (Eq. 5.4): the only pair of primitives that a state affords, and its actions.
/// In s3 the pair is tau_close with mu_carry, as Eq. 5.3 has it.
struct Affordance {
  const char* primary;        ///< tau.
  const char* complementary;  ///< mu.
  int points;                 ///< Pose points to choose from (g; 81 in s3, where zeta = 9).
  int parameters;             ///< Choices of the complementary primitive at each point.
  int actions() const { return points * parameters; }
};

/// @param state 0 to 3.
const Affordance& AffordanceOf(int state);

/// What an action index means: Eq. 5.7's product, points outermost.
struct ActionChoice {
  int point = 0;      ///< Grasp point in s0, s1, s3; place point in s2.
  int parameter = 0;  ///< Height and side in s0 (GraspLift), drag target in s1, else 0.
};

/// @param action in [0, AffordanceOf(state).actions()).
ActionChoice DecodeAction(int state, int action);

/// Without Psi every state offers the actions of all pairs, one pair after the other:
/// 81 + 81 + 9 + 81 = 252.
int AllActions();

/// @returns the pair (numbered by the state that affords it) that an index below AllActions()
/// belongs to, and in `action` its index among that pair's own.
int PairOfAction(int index, int& action);

/// How many actions each state offers, with Psi or without.
std::vector<int> ActionsOnOffer(bool affordances);

}  // namespace gusset
