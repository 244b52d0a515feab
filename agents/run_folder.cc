#include "agents/run_folder.h"

#include "agents/json_fields.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

constexpr const char* kPolicyFormat = "gusset policy 1";

std::string OneLine(std::string text) {
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

}  // namespace

nlohmann::json ReadJson(const std::filesystem::path& file) {
  const std::string text = ReadFile(file);
  try {
    return ParseJson(text);
  } catch (const nlohmann::json::exception& e) {
    throw InputError(file.string() + ": is not JSON: " + OneLine(e.what()));
  } catch (const InputError& e) {
    throw InputError(file.string() + ": " + e.what());
  }
}

RunFolder RunFolder::Create(const std::filesystem::path& root, const std::string& config_toml,
                            const nlohmann::ordered_json& run) {
  if (Exists(root / "config.toml")) {
    throw InputError(root.string() +
                     ": holds a run already; continue it with --resume or choose another --out");
  }
  RunFolder folder(root);
  for (const std::filesystem::path& part :
       {root / "checkpoint" / "state.json", folder.steps(), folder.policy()}) {
    if (!Exists(part)) continue;
    throw InputError(part.string() +
                     ": is of a run whose config.toml is gone; choose another --out");
  }
  MakeFolder(root);  // refuses an empty name
  MakeFolder(root / "checkpoint");
  MakeFolder(folder.frames());
  WriteFileAtomic(root / "run.json", JsonText(run));
  // Last: a folder with a config.toml is a run.
  WriteFileAtomic(folder.config(), config_toml);
  return folder;
}

RunFolder RunFolder::Open(const std::filesystem::path& root) {
  if (!Exists(root / "config.toml")) {
    throw InputError(root.string() + ": is not a run folder: it has no config.toml");
  }
  return RunFolder(root);
}

std::filesystem::path RunFolder::SnapshotFile(int id) const {
  return root_ / "checkpoint" / ("step" + std::to_string(id) + ".snapshot");
}

std::optional<nlohmann::json> RunFolder::ReadCheckpoint() const {
  const std::filesystem::path file = root_ / "checkpoint" / "state.json";
  if (!Exists(file)) return std::nullopt;
  return ReadJson(file);
}

void RunFolder::WriteCheckpoint(const nlohmann::json& checkpoint) const {
  WriteFileAtomic(root_ / "checkpoint" / "state.json", checkpoint.dump());
}

Snapshot RunFolder::ReadSnapshot(int id) const { return ReadFile(SnapshotFile(id)); }

void RunFolder::WriteSnapshot(int id, const Snapshot& snapshot) const {
  WriteFileAtomic(SnapshotFile(id), snapshot);
}

void RunFolder::RemoveSnapshot(int id) const {
  std::error_code ignored;
  std::filesystem::remove(SnapshotFile(id), ignored);
}

nlohmann::ordered_json PolicyJson(const Agent& agent, const nlohmann::ordered_json& about) {
  nlohmann::ordered_json policy = {{"format", kPolicyFormat}, {"agent", agent.name()}};
  if (!about.is_null()) policy.update(about);
  policy["learnt"] = agent.Save();
  return policy;
}

std::filesystem::path PolicyFile(const std::filesystem::path& policy) {
  if (!IsFolder(policy)) return policy;
  if (!Exists(policy / "policy.json")) {
    throw InputError(policy.string() + ": has no policy.json; its training has not ended");
  }
  return policy / "policy.json";
}

void LoadPolicy(const std::filesystem::path& file, Agent& agent) {
  const nlohmann::json policy = ReadJson(file);
  try {
    const auto format = JsonField<std::string>(policy, "format");
    if (format != kPolicyFormat) throw InputError("format is " + format + ", not " + kPolicyFormat);
    const auto name = JsonField<std::string>(policy, "agent");
    if (name != agent.name()) throw InputError("agent is " + name + ", not " + agent.name());
    agent.Load(JsonField<nlohmann::json>(policy, "learnt"));
  } catch (const InputError& e) {
    throw InputError(file.string() + ": " + OneLine(e.what()));
  }
}

}  // namespace gusset
