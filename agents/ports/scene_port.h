#pragma once

#include <cstdint>
#include <string>

namespace gusset {

/// How an episode starts.
enum class StartKind { kFolded, kUnfolded, kUnfoldedAnyPose, kFoldedAnyPose };

/// The whole world as opaque bytes; taken between actions only.
using Snapshot = std::string;

/// Sets the scene up. On a real rig a person does this.
class ScenePort {
 public:
  virtual ~ScenePort() = default;
  /// A new start, the same for the same kind and seed whatever ran before.
  virtual void Reset(StartKind kind, std::uint64_t seed) = 0;
  virtual Snapshot Save() = 0;
  /// Builds the world anew from a snapshot. sensor_seed fixes every sensor's noise from here on, so
  /// that an action's outcome depends on (snapshot, sensor_seed, action) alone.
  virtual void Restore(const Snapshot& snapshot, std::uint64_t sensor_seed) = 0;
  /// Simulated (or wall) seconds since the scene was made.
  virtual double time_s() const = 0;
};

}  // namespace gusset
