#include "tests/validation/experiment.h"

#include <cmath>
#include <cstdio>
#include <numeric>

namespace gusset {
namespace {

SimConfig ReadSim(ConfigTree& tree) {
  SimConfig config;
  config.Read(tree);
  return config;
}

}  // namespace

Rig::Rig(const Settings& from)
    : settings(from),
      scene(ReadSim(settings.tree)),
      referee(scene, settings.bagging.perception, settings.bagging.chosen_thresholds()),
      env(scene, scene, scene.robot(), referee, settings.bagging) {}

double Readings::mean() const {
  if (values_.empty()) return 0;
  return std::accumulate(values_.begin(), values_.end(), 0.0) / static_cast<double>(values_.size());
}

double Readings::deviation() const {
  if (values_.size() < 2) return 0;
  double sum = 0;
  for (const double v : values_) sum += (v - mean()) * (v - mean());
  return std::sqrt(sum / static_cast<double>(values_.size() - 1));
}

double Readings::error() const {
  return values_.empty() ? 0 : deviation() / std::sqrt(static_cast<double>(values_.size()));
}

std::string Row(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row;
}

std::string Number(double value, const char* format) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

}  // namespace gusset
