#pragma once

#include <nlohmann/json.hpp>

#include "agents/environment.h"

namespace gusset {

/// What an outcome adds to an action's line of steps.jsonl, and to the JSON file of its frames.
inline nlohmann::ordered_json OutcomeFields(const Outcome& outcome) {
  nlohmann::ordered_json fields = {{"reward", outcome.reward},
                                   {"next_state", outcome.next.state},
                                   {"next_state_true", outcome.truth.state},
                                   {"done", outcome.done},
                                   {"success", outcome.success},
                                   {"success_true", outcome.true_success}};
  fields.update(outcome.log);
  return fields;
}

}  // namespace gusset
