#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agents/agent.h"
#include "agents/bagging_env.h"
#include "agents/deep/config.h"
#include "agents/pi_learning.h"
#include "agents/q_learning.h"
#include "agents/trainer.h"
#include "agents/ucb1.h"
#include "agents/workers.h"
#include "tools/gusset/wiring.h"

namespace gusset {

/// What --seed takes: whole numbers that any reader of JSON keeps (RFC 8259, section 6).
inline CLI::Range SeedRange() { return CLI::Range(0.0, 9007199254740991.0, "INT in [0 - 2^53)"); }

/// Options that every subcommand takes.
struct CommonOptions {
  std::vector<std::string> config_files;  ///< --config, later ones win.
  std::vector<std::string> assignments;   ///< --set section.key=value, after all files.
  std::string log_level = "info";

  void AddTo(CLI::App& command);
  /// What --config and --set give, in this order, over what is in `tree`. @throws InputError.
  void ReadInto(ConfigTree& tree) const;
  /// Sends the log to stderr at the level asked for.
  void StartLog() const;
};

/// Everything a run is configured by, read and checked.
struct Settings {
  ConfigTree tree;
  BaggingConfig bagging;
  TrainConfig train;
  PiConfig pi;
  QLearningConfig q_learning;
  Ucb1Config ucb1;
  DeepConfig deep;
  std::string resolved;  ///< config.toml: every value that took effect.

  /// Makes environments, each with a world of its own.
  Workers::Factory EnvironmentFactory() const;
};

/// An option that stands for one config value.
struct Assignment {
  std::string option;                ///< "--steps", for errors.
  std::string key;                   ///< "train.steps".
  std::optional<std::string> value;  ///< As given, if it was.
};

/// Where settings come from, in this order, later ones winning; --config and --set come after bag
/// and before assignments.
struct SettingsSource {
  std::filesystem::path base = {};      ///< A run's config.toml; empty: none.
  std::optional<std::string> bag = {};  ///< --bag; with a base only if it is another bag.
  std::vector<Assignment> assignments = {};
};

/// @throws InputError naming file, line, key, value and bound.
Settings LoadSettings(const CommonOptions& common, const SettingsSource& source);

/// Reads every section that any command knows, for a command that needs but some of them.
/// @throws InputError as LoadSettings, for keys that nothing knows too.
void RefuseUnknownKeys(ConfigTree& tree);

/// What --config and --set change, as "section.key = value", of all that an evaluation depends on:
/// not [train] nor the learners' sections, which say how a policy was learnt (but for
/// train.affordances). The options as given where nothing can be loaded without them.
/// @param settings of both.
std::vector<std::string> ChangesBy(const CommonOptions& common, SettingsSource source,
                                   const Settings& settings);

/// The file of a bag by name ("bag1") or path. @throws InputError listing the names there are.
std::filesystem::path BagFile(const std::string& bag);

/// Where the settings of a policy come from: the config.toml in its folder; if there is none, the
/// bag that policy.json names is taken, unless `bag` is another. "random" has neither.
/// @throws InputError if policy.json cannot be read or there is no such bag.
SettingsSource SourceOf(const std::string& policy, const std::optional<std::string>& bag);

/// A new learner of the kind that `settings.train.agent` names.
/// @throws InputError if it is a network and this build has none.
std::unique_ptr<Agent> MakeAgent(const Settings& settings);

/// A learner as evaluate and play use it: from a run folder, a policy file, or "random".
std::unique_ptr<Agent> LoadAgent(const std::string& policy, const Settings& settings);

/// Versions of this program and of what its results depend on, networks apart.
nlohmann::ordered_json Versions();
/// The same with what networks rest on, if the learner is one and has been made.
nlohmann::ordered_json Versions(const Settings& settings);

/// Prints the one JSON document of --json. @throws RunError if stdout cannot take it.
void PrintJson(const nlohmann::ordered_json& document);

/// From now on Ctrl-C and SIGTERM request a stop (base/stop.h); a second one kills.
void WatchForStop();

}  // namespace gusset
