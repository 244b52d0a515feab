#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "agents/environment.h"

namespace gusset {

/// An environment that keeps what its actions lead to in a folder, and answers from there when an
/// action has been done before: to the same world, under the same noise. An outcome depends on
/// these alone, so work that was interrupted catches up without acting, in whatever order.
class JournalEnvironment final : public Environment {
 public:
  /// @param folder  made when the first action is kept; an action takes a file of about 100 KB.
  /// @param actor  all that an outcome depends on beside world, noise and action: the program and
  ///   its config. What others have kept does not count.
  JournalEnvironment(std::unique_ptr<Environment> environment, std::filesystem::path folder,
                     std::string actor);

  std::vector<int> ActionCounts() const override { return environment_->ActionCounts(); }
  Snapshot Start(StartKind kind, std::uint64_t seed) override {
    return environment_->Start(kind, seed);
  }
  Percept Begin(const Snapshot& snapshot, std::uint64_t sensor_seed) override;
  /// What was kept but is broken is done again. @throws InputError, RunError if nothing can be
  /// kept.
  Outcome Act(int action) override;
  /// Those of the last action that was not answered from the folder.
  FrameWriter Frames() const override { return environment_->Frames(); }

 private:
  std::unique_ptr<Environment> environment_;
  std::filesystem::path folder_;
  std::string actor_;
  std::uint64_t world_ = 0;  // of the last Begin: actor, snapshot and noise in one number
};

}  // namespace gusset
