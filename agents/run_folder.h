#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "agents/agent.h"
#include "agents/ports/scene_port.h"

namespace gusset {

/// Where a training run keeps what it knows:
///
///   config.toml    every value that took effect
///   run.json       seed, versions, machine
///   steps.jsonl    one line per action
///   progress.csv   one line per action, for plotting
///   policy.json    what was learnt
///   checkpoint/    state.json and snapshots of worlds, from which --resume continues
///   frames/        pictures, if asked for
class RunFolder {
 public:
  /// A new run. @throws InputError if the folder holds a run already, or parts of one, or cannot be
  /// written.
  static RunFolder Create(const std::filesystem::path& root, const std::string& config_toml,
                          const nlohmann::ordered_json& run);
  /// An existing one. @throws InputError if it is none.
  static RunFolder Open(const std::filesystem::path& root);

  const std::filesystem::path& root() const { return root_; }
  std::filesystem::path config() const { return root_ / "config.toml"; }
  std::filesystem::path steps() const { return root_ / "steps.jsonl"; }
  std::filesystem::path progress() const { return root_ / "progress.csv"; }
  std::filesystem::path policy() const { return root_ / "policy.json"; }
  std::filesystem::path frames() const { return root_ / "frames"; }
  /// Where the world is kept as step `id` left it, if it is.
  std::filesystem::path SnapshotFile(int id) const;

  /// The last checkpoint; nothing if the run stopped before its first.
  std::optional<nlohmann::json> ReadCheckpoint() const;
  void WriteCheckpoint(const nlohmann::json& checkpoint) const;
  Snapshot ReadSnapshot(int id) const;
  void WriteSnapshot(int id, const Snapshot& snapshot) const;
  void RemoveSnapshot(int id) const;

 private:
  explicit RunFolder(std::filesystem::path root) : root_(std::move(root)) {}
  std::filesystem::path root_;
};

/// Reads a JSON file. @throws InputError `file: why`, in one line.
nlohmann::json ReadJson(const std::filesystem::path& file);

/// What policy.json holds: the agent's name, what it learnt and what `about` says of the run.
nlohmann::ordered_json PolicyJson(const Agent& agent, const nlohmann::ordered_json& about);

/// The file that `policy` means: a run folder's policy.json, or the file itself.
std::filesystem::path PolicyFile(const std::filesystem::path& policy);

/// Loads what policy.json holds into an agent of the same name. @throws InputError naming file and
/// field.
void LoadPolicy(const std::filesystem::path& file, Agent& agent);

}  // namespace gusset
