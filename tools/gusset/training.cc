#include "tools/gusset/training.h"

#include <unistd.h>

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include "agents/affordances.h"
#include "agents/image_file.h"
#include "agents/plots.h"
#include "agents/replay.h"
#include "agents/report/contact_sheet.h"
#include "base/error.h"
#include "base/files.h"
#include "base/stop.h"
#include "tools/gusset/testbed_env.h"

namespace gusset {
namespace {

// Values by "section.key" of settings as they are written, one line each, in their order.
std::vector<std::pair<std::string, std::string>> Values(const std::string& settings) {
  std::vector<std::pair<std::string, std::string>> values;
  std::istringstream lines(settings);
  std::string section;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('[')) section = line.substr(1, line.find(']') - 1) + ".";
    const auto equals = line.find(" = ");
    if (equals != std::string::npos) {
      values.emplace_back(section + line.substr(0, equals), line.substr(equals + 3));
    }
  }
  return values;
}

// @returns in which way a run was begun with other settings; empty if in none.
std::string FirstDifference(const std::string& then, const std::string& now) {
  if (then == now) return "";
  const auto old_values = Values(then);
  for (const auto& [key, value] : Values(now)) {
    const auto old =
        std::ranges::find(old_values, key, &std::pair<std::string, std::string>::first);
    if (old == old_values.end()) return "without " + key + ", which is " + value + " now";
    if (old->second != value) return "with " + key + " = " + old->second + ", not " + value;
  }
  return "with settings that are not known any more";
}

constexpr const char* kLastPicture = "curve.png";

// How the mean reward of each state's pose points looks on a bag in that state, and the curve.
void DrawPictures(const RunFolder& folder, const Settings& settings) {
  const std::vector<LoggedStep> logged = ReadLoggedSteps(folder.steps());
  ConfigTree tree = settings.tree;
  TestbedEnv environment(MakeTestbed(tree), settings.bagging);
  const std::vector<nlohmann::json> steps = ReadRunSteps(folder.root());
  for (int s = 0; s < kActingStates; ++s) {
    int step = 0;
    while (step < static_cast<int>(steps.size()) &&
           steps[static_cast<std::size_t>(step)].at("state") != s)
      ++step;
    if (step == static_cast<int>(steps.size())) continue;
    const Snapshot world = WorldBefore(environment, steps, step);
    environment.Begin(world, steps[static_cast<std::size_t>(step)].at("sensor_seed"));
    WriteImage(
        folder.root() / ("reward_map_s" + std::to_string(s) + ".png"),
        DrawRewardMap(environment.bagging().frame_before().color, environment.bagging().before(),
                      MeanRewards(logged, s, AffordanceOf(s).points)));
  }
  WriteImage(folder.root() / kLastPicture, DrawLearningCurve(logged, kActingStates));
}

RunFolder CreateRun(const std::filesystem::path& out, const Settings& settings) {
  char host[256] = "";
  ::gethostname(host, sizeof host - 1);
  ConfigTree tree = settings.tree;
  return RunFolder::Create(out, settings.resolved,
                           {{"seed", settings.train.seed},
                            {"versions", Versions(settings)},
                            {"renderer", MakeTestbed(tree)->renderer()},
                            {"host", host}});
}

}  // namespace

RunFolder OpenRun(const std::filesystem::path& out, const Settings& settings) {
  RunFolder folder = RunFolder::Open(out);
  const std::string difference = FirstDifference(ReadFile(folder.config()), settings.resolved);
  if (!difference.empty()) {
    throw InputError(folder.config().string() + ": the run was begun " + difference);
  }
  return folder;
}

TrainSummary TrainInFolder(const std::filesystem::path& out, const Settings& settings, bool resume,
                           int jobs, const std::function<bool()>& stop,
                           const EnvironmentWrap& wrap) {
  // Before the folder, which would hold a run of an agent that this build does not have.
  const std::unique_ptr<Agent> agent = MakeAgent(settings);
  if (!resume) MakeFolder(out);
  const FolderLock lock(out);
  const RunFolder folder = resume ? OpenRun(out, settings) : CreateRun(out, settings);
  TrainSummary summary;
  {
    const Workers::Factory bare = settings.EnvironmentFactory();
    Workers workers(jobs, [&] { return wrap ? wrap(bare()) : bare(); });
    const nlohmann::ordered_json about = {{"bag", settings.train.bag},
                                          {"protocol", settings.train.protocol},
                                          {"seed", settings.train.seed}};
    const auto train = [&] { return Train(workers, *agent, settings.train, folder, about, stop); };
    summary = settings.train.dump == "none" ? train() : WithContactSheet(folder.frames(), train);
  }
  try {
    DrawPictures(folder, settings);
  } catch (const Interrupted&) {
    throw RunError("interrupted after the training, before all its pictures were drawn; " +
                   folder.root().string() + " can be continued with --resume");
  }
  return summary;
}

bool HasPictures(const std::filesystem::path& run) { return Exists(run / kLastPicture); }

}  // namespace gusset
