#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "agents/ports/referee.h"
#include "agents/ports/scene_port.h"

namespace gusset {

/// What a learner knows about the moment.
struct Percept {
  int state = 0;
  std::vector<double> features = {};  ///< The state's continuous part; may be empty.
};

/// What one action led to.
struct Outcome {
  Percept next;
  double reward = 0;
  bool done = false;           ///< The episode is over.
  bool success = false;        ///< ... and, as far as the camera can tell, the task is done.
  Truth truth;                 ///< Ground truth afterwards: for evaluator and logger alone.
  bool true_success = false;   ///< By ground truth.
  Snapshot after;              ///< The world afterwards.
  double sim_s = 0;            ///< Simulated time that passed.
  nlohmann::ordered_json log;  ///< What else the log should hold.
};

/// True if an action of `state` brought a later state of the task or, from the last one, success:
/// as the camera saw it.
inline bool Advanced(int state, const Outcome& outcome) {
  return outcome.success || (!outcome.done && outcome.next.state > state);
}

/// Writes what the camera saw before and after one action, to files whose names begin with
/// `prefix`. `about` is what else is known of the action; it goes into PREFIX.json.
/// @throws InputError or RunError if they cannot be written, in one line.
using FrameWriter =
    std::function<void(const std::filesystem::path& prefix, const nlohmann::ordered_json& about)>;

/// An episodic task with discrete actions whose world can be saved and restored. An action's
/// outcome depends on (snapshot, sensor seed, action) alone, so actions can be run again, anywhere,
/// in any order: resuming, replaying and running several at once all rest on that. Starts and
/// actions throw Interrupted once a stop was requested (base/stop.h).
class Environment {
 public:
  virtual ~Environment() = default;
  /// How many actions each state affords; states after these afford none.
  virtual std::vector<int> ActionCounts() const = 0;
  /// A new start, as a snapshot.
  virtual Snapshot Start(StartKind kind, std::uint64_t seed) = 0;
  /// Builds the world anew and looks at it.
  virtual Percept Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) = 0;
  /// Performs `action` in the world of the last Begin. Once per Begin.
  virtual Outcome Act(int action) = 0;
  /// The frames of the last action. They can be written later, from any thread.
  virtual FrameWriter Frames() const = 0;
};

}  // namespace gusset
