// Whole actions as learners have them: physics, arm, looks, perception; and training.

#include <fcntl.h>
#include <malloc.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <barrier>
#include <filesystem>
#include <fstream>

#include "agents/affordances.h"
#include "base/error.h"
#include "base/random.h"
#include "tools/gusset/bench/looks.h"
#include "tools/gusset/bench/suite.h"
#include "tools/gusset/bench/timing.h"
#include "tools/gusset/testbed_env.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

constexpr int kPerState = 3;
constexpr int kMostEpisodes = 100;
constexpr int kMostActions = 12;

/// An action that can be done again: everything it depends on.
struct ActionCase {
  int state = 0;
  Snapshot world;
  std::uint64_t sensor_seed = 0;
  int action = 0;
};

double Perform(Environment& environment, const ActionCase& c) {
  environment.Begin(c.world, c.sensor_seed);
  return environment.Act(c.action).sim_s;
}

int RandomAction(const std::vector<int>& counts, int state, std::uint64_t index) {
  Rng rng(DeriveSeed(kBenchSeed, "bench action", index));
  return rng.Below(counts[static_cast<std::size_t>(state)]);
}

// The first kPerState worlds that are seen in each state, s0 from folded starts, the others on
// random walks from unfolded ones, with a random action each.
std::vector<ActionCase> DrawActions(Environment& environment) {
  const std::vector<int> counts = environment.ActionCounts();
  std::vector<std::vector<ActionCase>> found(kActingStates);
  const auto keep = [&](int state, const Snapshot& world, std::uint64_t index) {
    auto& cases = found[static_cast<std::size_t>(state)];
    if (static_cast<int>(cases.size()) == kPerState) return;
    const std::uint64_t sensor_seed = DeriveSeed(kBenchSeed, "bench sensor", index);
    cases.push_back({state, world, sensor_seed, RandomAction(counts, state, index)});
  };
  const auto all_found = [&] {
    return std::ranges::all_of(
        found, [](const auto& cases) { return static_cast<int>(cases.size()) == kPerState; });
  };
  for (std::uint64_t episode = 0; !all_found(); ++episode) {
    if (episode == kMostEpisodes) throw RunError("bench: random walks do not reach all states");
    const bool folded = static_cast<int>(found[0].size()) < kPerState;
    Snapshot world = environment.Start(folded ? StartKind::kFolded : StartKind::kUnfolded,
                                       DeriveSeed(kBenchSeed, "bench start", episode));
    for (std::uint64_t i = 0; i < kMostActions && !all_found(); ++i) {
      const std::uint64_t index = episode * kMostActions + i;
      const int state =
          environment.Begin(world, DeriveSeed(kBenchSeed, "bench sensor", index)).state;
      if (state >= kActingStates) break;
      keep(state, world, index);
      if (folded) break;
      Outcome outcome = environment.Act(RandomAction(counts, state, index));
      if (outcome.done) break;
      world = std::move(outcome.after);
    }
  }
  std::vector<ActionCase> cases;
  for (const auto& of_state : found) cases.insert(cases.end(), of_state.begin(), of_state.end());
  return cases;
}

double ResidentMb() {
  ::malloc_trim(0);
  long total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

/// A folder that is gone when this is.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "gusset_bench_XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw RunError("bench: cannot make " + pattern);
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// This program again, its standard output thrown away. @returns its exit code.
int RunSelf(std::vector<std::string> arguments, const std::string& cache) {
  arguments.insert(arguments.begin(), "gusset");
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  std::string cache_variable = "GUSSET_CACHE=" + cache;
  std::vector<char*> environment = {cache_variable.data()};
  for (char** variable = environ; *variable != nullptr; ++variable) {
    if (!std::string(*variable).starts_with("GUSSET_CACHE=")) environment.push_back(*variable);
  }
  environment.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = -1;
  const int error =
      posix_spawn(&child, "/proc/self/exe", &files, nullptr, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) throw RunError("bench: cannot start this program again");
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

}  // namespace

Measured MeasureActions(const BenchContext& context) {
  const std::unique_ptr<Environment> environment = context.settings.EnvironmentFactory()();
  const std::vector<ActionCase> cases = DrawActions(*environment);
  std::vector<std::vector<double>> wall_s(cases.size());
  std::vector<double> sim_s(cases.size());
  for (int round = 0; round < (context.quick ? 1 : 3); ++round) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const Spent spent = TimeOf([&] { sim_s[i] = Perform(*environment, cases[i]); });
      wall_s[i].push_back(spent.wall_s);
    }
  }
  Measured measured;
  double simulated = 0, spent = 0;
  std::vector<double> each_ms;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const double wall = Median(wall_s[i]);
    simulated += sim_s[i];
    spent += wall;
    each_ms.push_back(1e3 * wall);
    measured.detail["actions"].push_back({{"state", "s" + std::to_string(cases[i].state)},
                                          {"action", cases[i].action},
                                          {"simulated_s", sim_s[i]},
                                          {"wall_s", wall}});
  }
  measured.detail["longest_s"] = *std::ranges::max_element(sim_s);
  measured.detail["longer_than_12_s"] =
      std::ranges::count_if(sim_s, [](double seconds) { return seconds > 12; });
  measured.figures["rtf_action"] = simulated / spent;
  measured.figures["action_ms"] = Median(each_ms);
  return measured;
}

// Threads, as the trainer's, each with a world of its own that does the same actions.
Measured MeasureTwoCores(const BenchContext& context) {
  std::vector<ActionCase> cases;
  Workers one(1, context.settings.EnvironmentFactory());
  Workers two(2, context.settings.EnvironmentFactory());
  one.Run({[&](Environment& environment) {
    // One of each state.
    const std::vector<ActionCase> drawn = DrawActions(environment);
    for (std::size_t i = 0; i < drawn.size(); i += kPerState) cases.push_back(drawn[i]);
  }});
  std::barrier both(2);
  const auto perform_all = [&](Environment& environment) {
    for (const ActionCase& c : cases) Perform(environment, c);
  };
  const auto after_the_other = [&](Environment& environment) {
    both.arrive_and_wait();  // so that each thread takes one
    perform_all(environment);
  };
  two.Run({after_the_other, after_the_other});  // makes both worlds
  Rate alone{.done = 1}, together{.done = 2};
  for (int round = 0; round < (context.quick ? 1 : 3); ++round) {
    alone.runs.push_back(TimeOf([&] { one.Run({perform_all}); }));
    together.runs.push_back(TimeOf([&] { two.Run({after_the_other, after_the_other}); }));
  }
  Measured measured;
  measured.figures["two_core_speedup"] = together.per_wall_s() / alone.per_wall_s();
  measured.detail = {{"worlds_in", "threads"},
                     {"actions_each", cases.size()},
                     {"one", alone.Json()},
                     {"two", together.Json()}};
  return measured;
}

// What a further world holds after an action, renderer, arm and perception included.
Measured MeasureMemory(const BenchContext& context) {
  constexpr int kWorlds = 4;
  const auto make = context.settings.EnvironmentFactory();
  std::vector<std::unique_ptr<Environment>> worlds;
  std::vector<double> mb;
  for (int i = 0; i <= kWorlds; ++i) {
    worlds.push_back(make());
    Environment& environment = *worlds.back();
    const Snapshot start = environment.Start(StartKind::kUnfolded, kBenchSeed);
    const int state = environment.Begin(start, kBenchSeed).state;
    if (state != 1) throw RunError("bench: an unfolded bag is not seen as s1");
    environment.Act(RandomAction(environment.ActionCounts(), state, 0));
    mb.push_back(ResidentMb());
  }
  Measured measured;
  measured.figures["world_mb"] = (mb.back() - mb.front()) / kWorlds;
  measured.detail = {{"resident_mb", mb}};
  return measured;
}

// The command that users give, in a process of its own, without any start made before.
Measured MeasureTraining(const BenchContext& context) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {"train",
                                        "--agent",
                                        "pi",
                                        "--steps",
                                        "100",
                                        "--seed",
                                        "1",
                                        "--jobs",
                                        "2",
                                        "--out",
                                        (folder.path() / "run").string(),
                                        "--log-level",
                                        "warn"};
  arguments.insert(arguments.end(), context.settings_arguments.begin(),
                   context.settings_arguments.end());
  int code = -1;
  const Spent spent =
      TimeOf([&] { code = RunSelf(arguments, (folder.path() / "cache").string()); });
  if (code != 0) throw RunError("bench: training ended with exit code " + std::to_string(code));
  Measured measured;
  measured.figures["train_s"] = spent.wall_s;
  measured.detail = {{"command", "train --agent pi --bag bag1 --steps 100 --seed 1 --jobs 2"},
                     {"start_cache", "empty"}};
  return measured;
}

}  // namespace gusset
