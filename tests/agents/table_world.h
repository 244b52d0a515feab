#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "agents/environment.h"
#include "base/error.h"
#include "base/files.h"
#include "base/random.h"
#include "base/stop.h"
#include "tests/temporary_folder.h"

namespace gusset {

/// A bagging task without a bag: four states, the next one reached with a probability that depends
/// on the action. In state s action s + 1 is the best. Snapshots are the state and a number that
/// stands for everything else about the world.
class TableWorld final : public Environment {
 public:
  /// @param crash_at, stop_at the Act (counted from 0, of this object) that throws, and during
  /// which Ctrl-C is pressed; -1: none.
  explicit TableWorld(int crash_at = -1, int stop_at = -1)
      : crash_at_(crash_at), stop_at_(stop_at) {}

  std::vector<int> ActionCounts() const override { return {6, 6, 3, 9}; }
  Snapshot Start(StartKind kind, std::uint64_t seed) override {
    const int state = kind == StartKind::kFolded || kind == StartKind::kFoldedAnyPose ? 0 : 1;
    return Pack(state, seed);
  }
  Percept Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) override {
    state_ = std::stoi(snapshot);
    world_ = std::stoull(snapshot.substr(2));
    // Now and then noise shows another state, as at the threshold of an area.
    Rng rng(DeriveSeed(world_, "look", sensor_seed));
    sensor_seed_ = sensor_seed;
    if (state_ > 0 && rng.Uniform() < 0.1) --state_;
    return {state_, {}};
  }
  Outcome Act(int action) override {
    if (acts_ == stop_at_) RequestStop();
    ThrowIfStopped();
    if (acts_++ == crash_at_) throw RunError("the world came apart");
    Rng rng(DeriveSeed(world_, "act", sensor_seed_ * 64 + static_cast<std::uint64_t>(action)));
    const bool best = action == std::min(state_ + 1, ActionCounts()[At()] - 1);
    const bool advance = rng.Uniform() < (best ? 0.9 : 0.2);
    Outcome outcome;
    outcome.reward = (best ? 1.0 : 0.3) + 0.1 * rng.Normal();
    outcome.next.state = advance ? state_ + 1 : state_;
    if (state_ == 3) outcome.next.state = advance ? 4 : 5;
    outcome.done = outcome.next.state >= 4;
    outcome.success = outcome.next.state == 4;
    outcome.truth.state = outcome.next.state;
    outcome.true_success = outcome.success && rng.Uniform() < 0.9;
    outcome.after = Pack(outcome.next.state, rng.Bits());
    outcome.sim_s = 10;
    outcome.log = {{"point", action}, {"note", ""}};
    return outcome;
  }
  FrameWriter Frames() const override {
    return [](const std::filesystem::path& prefix, const nlohmann::ordered_json& about) {
      nlohmann::ordered_json document = about;
      document["before"] = document["after"] = nlohmann::ordered_json::object();
      WriteFileAtomic(prefix.string() + ".json", document.dump());
    };
  }

 private:
  static Snapshot Pack(int state, std::uint64_t world) {
    return std::to_string(state) + " " + std::to_string(world);
  }
  std::size_t At() const { return static_cast<std::size_t>(state_); }

  int crash_at_;
  int stop_at_;
  int acts_ = 0;
  int state_ = 0;
  std::uint64_t world_ = 0;
  std::uint64_t sensor_seed_ = 0;
};

/// A folder of its own for each test, removed afterwards; in memory where that is possible, since
/// a trainer syncs every action and a busy disk takes 10 ms for each.
class FolderTest : public testing::Test {
 protected:
  static std::filesystem::path Parent() {
    const char* memory = "/dev/shm";
    const bool in_memory = std::getenv("TMPDIR") == nullptr && ::access(memory, W_OK) == 0;
    return in_memory ? memory : std::filesystem::temp_directory_path();
  }

  TemporaryFolder folder_{Parent()};
  std::filesystem::path dir_ = folder_.path();
};

}  // namespace gusset
