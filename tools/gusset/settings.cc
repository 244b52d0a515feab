#include "tools/gusset/settings.h"

#include <bullet/LinearMath/btScalar.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <csignal>
#include <iostream>
#include <map>
#include <opencv2/core/version.hpp>
#include <set>

#include "agents/affordances.h"
#include "agents/json_fields.h"
#include "agents/random_agent.h"
#include "agents/thompson_sampling.h"
#include "base/error.h"
#include "base/files.h"
#include "base/stop.h"
#include "sim/sim_scene.h"
#include "tools/gusset/deep_agents.h"
#include "tools/gusset/testbed_env.h"

namespace gusset {
namespace {

// What a run's bag had set must not hold for another bag whose file is silent on it.
void ForgetBag(const std::string& bag, ConfigTree& tree) {
  try {
    tree.Forget(BagFile(bag));
  } catch (const InputError&) {
    // Its file is gone. Nothing tells any more which values were the bag's.
  }
}

// @param key  what gives the name, for errors.
std::filesystem::path BagNamed(const std::string& bag, const std::string& key) {
  if (bag.ends_with(".toml")) return bag;
  const std::filesystem::path folder = AssetsFolder() / "bags";
  std::filesystem::path file = folder / (bag + ".toml");
  if (Exists(file)) return file;
  std::vector<std::string> names;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem());
  }
  std::ranges::sort(names);
  throw InputError(key + ": no bag is called " + bag +
                   "; there are: " + CLI::detail::join(names, ", "));
}

// The bag that a policy was learnt with.
std::optional<std::string> BagOf(const std::filesystem::path& policy) {
  const nlohmann::json document = ReadJson(policy);
  if (!document.is_object() || !document.contains("bag")) return std::nullopt;
  try {
    const auto bag = JsonField<std::string>(document, "bag");
    if (Exists(BagNamed(bag, "bag"))) return bag;
    throw InputError("bag: there is no file " + bag);
  } catch (const InputError& e) {
    throw InputError(policy.string() + ": " + e.what());
  }
}

extern "C" void OnStopSignal(int) { RequestStop(); }

template <class Visitor>
void VisitLearners(Settings& settings, Visitor visit) {
  visit("pi", settings.pi);
  visit("q_learning", settings.q_learning);
  visit("ucb1", settings.ucb1);
  visit("dqn", settings.deep.dqn);
  visit("a2c", settings.deep.a2c);
  visit("ppo", settings.deep.ppo);
}

// Reads what the environment and the learner need; the world's sections are left to MakeTestbed.
void ReadSections(Settings& settings) {
  const TrainConfig& train = settings.train;
  settings.tree.Read("train", settings.train);
  VisitLearners(settings,
                [&](const char* section, auto& config) { settings.tree.Read(section, config); });
  settings.pi.steps_per_state = train.steps;
  settings.q_learning.steps_per_state = train.steps;
  settings.deep.total_steps = std::int64_t{kActingStates} * train.steps;
  settings.deep.seed = static_cast<std::uint64_t>(train.seed);
  settings.bagging.Read(settings.tree);
  settings.bagging.affordances = train.affordances;
}

// A learner that needs no network; nothing if the settings ask for one.
std::unique_ptr<Agent> MakeTabularAgent(const Settings& settings) {
  const std::string& name = settings.train.agent;
  const std::vector<int> n_actions = ActionsOnOffer(settings.train.affordances);
  if (name == "pi") return std::make_unique<PiLearning>(settings.pi, n_actions);
  if (name == "q_learning") return std::make_unique<QLearning>(settings.q_learning, n_actions);
  if (name == "ucb1") return std::make_unique<Ucb1>(settings.ucb1, n_actions);
  if (name == "thompson") return std::make_unique<ThompsonSampling>(n_actions);
  if (name == "random") return std::make_unique<RandomAgent>();
  return nullptr;
}

}  // namespace

void CommonOptions::AddTo(CLI::App& command) {
  command.add_option("--config", config_files, "TOML file read over the defaults (repeatable)")
      ->type_name("FILE")
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--set", assignments, "One value, as section.key=value (repeatable)")
      ->type_name("KEY=VALUE")
      ->take_all()
      ->allow_extra_args(false);
  command.add_option("--log-level", log_level, "What is logged to stderr")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
}

void CommonOptions::ReadInto(ConfigTree& tree) const {
  for (const std::string& file : config_files) tree.Load(file);
  for (const std::string& assignment : assignments) tree.Set(assignment);
}

void CommonOptions::StartLog() const {
  const auto logger = std::make_shared<spdlog::logger>(
      "gusset", std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  logger->set_pattern("%H:%M:%S %^%l%$ %v");
  logger->set_level(spdlog::level::from_str(log_level));
  spdlog::set_default_logger(logger);
}

std::filesystem::path BagFile(const std::string& bag) { return BagNamed(bag, "--bag"); }

SettingsSource SourceOf(const std::string& policy, const std::optional<std::string>& bag) {
  if (policy == "random") return {.bag = bag};
  const std::filesystem::path path = policy;
  const std::filesystem::path config = (IsFolder(path) ? path : path.parent_path()) / "config.toml";
  if (Exists(config)) return {.base = config, .bag = bag};
  if (bag) return {.bag = bag};
  return {.bag = BagOf(PolicyFile(path))};
}

void RefuseUnknownKeys(ConfigTree& tree) {
  Settings settings;
  settings.tree = tree;
  ReadSections(settings);
  SimConfig().Read(settings.tree);
  settings.tree.RefuseUnknown();
}

Settings LoadSettings(const CommonOptions& common, const SettingsSource& source) {
  Settings settings;
  std::optional<std::string> bag = source.bag;
  if (!source.base.empty()) {
    settings.tree.Load(source.base);
    settings.tree.Read("train", settings.train);
  }
  ConfigTree given;
  common.ReadInto(given);
  TrainConfig asked = settings.train;
  given.Read("train", asked);
  // A run's config.toml given to --config says which bag its [bag] is.
  if (source.base.empty() && !bag) bag = asked.bag;
  const std::string used = bag.value_or(settings.train.bag);
  if (asked.bag != used) {
    given.RefuseIfGiven("train.bag", "is not the bag " + used + " of --bag or --policy");
  }
  if (!source.base.empty()) {
    // A run's config holds its bag already, as --set may have changed it.
    if (bag == settings.train.bag) {
      bag.reset();
    } else if (bag) {
      ForgetBag(settings.train.bag, settings.tree);
    }
  }
  if (bag) settings.tree.Load(BagFile(*bag));
  common.ReadInto(settings.tree);
  if (bag) settings.tree.SetText("train.bag", *bag, "--bag");
  for (const Assignment& a : source.assignments) {
    if (a.value) settings.tree.Set(a.key + "=" + *a.value, a.option);
  }
  ReadSections(settings);

  // The world is built once, so that every section is read, every file it names opened and every
  // mistake found before anything is written.
  const std::unique_ptr<Testbed> testbed = MakeTestbed(settings.tree);
  settings.tree.RefuseUnknown();
  AppendToml("train", settings.train, settings.resolved);
  VisitLearners(settings, [&](const char* section, const auto& config) {
    AppendToml(section, config, settings.resolved);
  });
  settings.bagging.AppendTo(settings.resolved);
  testbed->AppendConfig(settings.resolved);
  return settings;
}

std::vector<std::string> ChangesBy(const CommonOptions& common, SettingsSource source,
                                   const Settings& settings) {
  if (common.config_files.empty() && common.assignments.empty()) return {};
  if (source.base.empty()) source.bag = settings.train.bag;
  std::map<std::string, std::string> plain;
  try {
    plain = FlattenResolved(LoadSettings(CommonOptions(), source).resolved);
  } catch (const InputError&) {  // which the options mend: they can but be named
    std::vector<std::string> given;
    for (const std::string& file : common.config_files) given.push_back("--config " + file);
    for (const std::string& assignment : common.assignments) given.push_back("--set " + assignment);
    return given;
  }
  std::set<std::string> of_training = {"train"};
  Settings learners;
  VisitLearners(learners, [&](const char* section, const auto&) { of_training.insert(section); });
  std::vector<std::string> changes;
  for (const auto& [key, value] : FlattenResolved(settings.resolved)) {
    const bool acts =
        key == "train.affordances" || !of_training.contains(key.substr(0, key.find('.')));
    const auto before = plain.find(key);
    if (acts && (before == plain.end() || before->second != value)) {
      changes.push_back(key + " = " + value);
    }
  }
  return changes;
}

Workers::Factory Settings::EnvironmentFactory() const {
  return [tree = tree, bagging = bagging]() -> std::unique_ptr<Environment> {
    ConfigTree own = tree;
    return std::make_unique<TestbedEnv>(MakeTestbed(own), bagging);
  };
}

std::unique_ptr<Agent> MakeAgent(const Settings& settings) {
  std::unique_ptr<Agent> agent = MakeTabularAgent(settings);
  if (agent) return agent;
  return LoadDeepAgent(settings.train.agent, settings.deep,
                       ActionsOnOffer(settings.train.affordances));
}

std::unique_ptr<Agent> LoadAgent(const std::string& policy, const Settings& settings) {
  if (policy == "random") return std::make_unique<RandomAgent>();
  std::unique_ptr<Agent> agent = MakeAgent(settings);
  LoadPolicy(PolicyFile(policy), *agent);
  return agent;
}

nlohmann::ordered_json Versions() {
  const int bullet = BT_BULLET_VERSION;
  return {
      {"gusset", GUSSET_VERSION},
      {"bullet", std::to_string(bullet / 100) + "." + std::to_string(bullet % 100)},
      {"opencv", CV_VERSION},
      {"eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                    "." + std::to_string(EIGEN_MINOR_VERSION)},
      {"compiler", __VERSION__}};
}

nlohmann::ordered_json Versions(const Settings& settings) {
  nlohmann::ordered_json versions = Versions();
  // Not whatever happens to be loaded: another agent of this process may have needed it.
  if (!MakeTabularAgent(settings)) versions.update(LoadedDeepVersions());
  return versions;
}

void PrintJson(const nlohmann::ordered_json& document) {
  std::cout << JsonText(document) << std::flush;
}

void WatchForStop() {
  struct sigaction action = {};
  action.sa_handler = OnStopSignal;
  action.sa_flags = SA_RESETHAND | SA_RESTART;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace gusset
