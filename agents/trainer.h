#pragma once

#include <functional>
#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/frame_dump.h"
#include "agents/run_folder.h"
#include "agents/workers.h"
#include "base/config.h"

namespace gusset {

/// Names of all learners. The networks among them need a build with libtorch.
inline const std::vector<std::string>& AgentNames() {
  static const std::vector<std::string> names = {"pi",  "q_learning", "ucb1",       "thompson",
                                                 "dqn", "plain_dqn",  "double_dqn", "dueling_dqn",
                                                 "a2c", "ppo",        "random"};
  return names;
}

/// What a training run is. Section [train].
struct TrainConfig {
  std::string agent = "pi";
  bool affordances = true;  ///< False: every state offers all 252 actions (BaggingConfig).
  std::string bag = "bag1";
  std::string protocol = "pools";
  int steps = 100;  ///< Learnt steps per state, N.
  int seed = 1;
  int pool_min = 20;             ///< Bags a state's pool must hold before the state is trained.
  int max_extra_actions = 1000;  ///< In the whole run; then "pools" makes do with what it has.
  int max_actions = 20;          ///< Of one episode of protocol "chain".
  std::string dump = "none";     ///< Whose frames are kept (agents/frame_dump.h).

  template <class V>
  void Fields(V& v) {
    v("agent", agent, AgentNames());
    v("affordances", affordances);
    v("bag", bag, std::vector<std::string>{});
    v("protocol", protocol, std::vector<std::string>{"pools", "chain"});
    v("steps", steps, Range{1, 1000000});
    v("seed", seed, Range{0, 2147483647});
    v("pool_min", pool_min, Range{1, 10000});
    v("max_extra_actions", max_extra_actions, Range{0, 1000000});
    v("max_actions", max_actions, Range{1, 1000});
    v("dump", dump, DumpChoices());
  }
};

/// What a finished run amounts to.
struct TrainSummary {
  int actions = 0;        ///< All of them.
  int extra_actions = 0;  ///< Those that nothing was learnt from.
  double sim_s = 0;
};

/// Trains `agent` in the environments of `workers` and leaves the result in `folder`.
///
/// Protocol "pools": states are trained in order, N steps each. Steps in s0 start from new folded
/// bags, those in a later state from bags that earlier actions left in it, as the camera saw them
/// (its pool). A pool smaller than pool_min is first filled by the greedy policy's actions from the
/// pool before; they are logged as extra. Protocol "chain": acts in whatever state the camera
/// shows, learns until a state has its N steps, and is greedy there from then on.
///
/// Every random number derives from (seed, purpose, index). With "pools" the next steps are tried
/// in parallel with the policy as it is, and tried again where the policy, once it has learnt what
/// came before, decides otherwise: the result does not depend on the number of workers, whose
/// threads do all of it, `stop` included, one at a time but for the actions. Continues
/// from the folder's checkpoint if it has one; after a kill at any moment the end is the same.
///
/// @param stop asked between actions; when true, or when an action is Interrupted (base/stop.h),
/// the run ends with a RunError and can be resumed.
/// @param about goes into policy.json.
TrainSummary Train(Workers& workers, Agent& agent, const TrainConfig& config,
                   const RunFolder& folder, const nlohmann::ordered_json& about,
                   const std::function<bool()>& stop);

}  // namespace gusset
