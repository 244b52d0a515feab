#include "tools/gusset/bench/suite.h"

#include <spdlog/spdlog.h>
#include <stdlib.h>

#include <algorithm>
#include <fstream>
#include <thread>

#include "base/error.h"
#include "base/stop.h"
#include "sim/cloth/bag_mesh.h"
#include "tools/gusset/bench/looks.h"

namespace gusset {
namespace {

// The order of the contract in docs/performance.md.
constexpr const char* kFigures[] = {
    "rtf_awake", "rtf_action",       "vs_bt_deformable", "growth_exponent", "action_ms",
    "train_s",   "two_core_speedup", "world_mb",         "frame_ms",        "perception_ms"};

std::string ProcessorName() {
  std::ifstream info("/proc/cpuinfo");
  std::string line;
  while (std::getline(info, line)) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

bool Wanted(const Measurement& m, const std::vector<std::string>& only) {
  return only.empty() || std::ranges::any_of(m.figures, [&](const std::string& figure) {
           return std::ranges::find(only, figure) != only.end();
         });
}

}  // namespace

nlohmann::ordered_json DescribeMachine() {
  double load[1] = {0};
  ::getloadavg(load, 1);
  nlohmann::ordered_json machine = {{"cpu", ProcessorName()},
                                    {"cores", std::thread::hardware_concurrency()},
                                    {"load_before", load[0]},
                                    {"flags", GUSSET_BUILD_FLAGS}};
  machine["versions"] = Versions();
  return machine;
}

const std::vector<Measurement>& Measurements() {
  static const std::vector<Measurement> all = {
      {{"world_mb"}, MeasureMemory},
      {{"rtf_awake"}, MeasureAwake},
      {{"vs_bt_deformable"}, MeasureAgainstBtDeformable},
      {{"growth_exponent"}, MeasureGrowth},
      {{"frame_ms"}, MeasureFrame},
      {{"perception_ms"}, MeasurePerception},
      {{"rtf_action", "action_ms"}, MeasureActions},
      {{"two_core_speedup"}, MeasureTwoCores},
      {{"train_s"}, MeasureTraining, false},
  };
  return all;
}

nlohmann::ordered_json RunMeasurements(const BenchContext& context,
                                       const std::vector<std::string>& only) {
  nlohmann::ordered_json document;
  for (const char* figure : kFigures) document[figure] = nullptr;
  document["nodes"] = MakeBagMesh(SimConfigOf(context.settings).bag).node_count();
  document["machine"] = DescribeMachine();
  document["quick"] = context.quick;
  document["detail"] = nlohmann::ordered_json::object();
  for (const Measurement& m : Measurements()) {
    if (!Wanted(m, only) || (context.quick && !m.in_quick)) continue;
    ThrowIfStopped();
    spdlog::info("measuring {}", m.figures.front());
    const Measured measured = m.measure(context);
    for (const auto& [figure, value] : measured.figures.items()) {
      document[figure] = value;
      spdlog::info("{} = {:.4g}", figure, value.get<double>());
    }
    document["detail"][m.figures.front()] = measured.detail;
  }
  return document;
}

}  // namespace gusset
