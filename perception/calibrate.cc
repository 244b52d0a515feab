#include "perception/calibrate.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"

namespace gusset {
namespace {

template <class T>
T Median(std::vector<T> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

}  // namespace

Calibration CalibrateThresholds(const std::vector<Observation>& looks, int labels_per_layer) {
  double largest = 0;
  for (const Observation& look : looks) largest = std::max(largest, look.A_bag);
  std::vector<double> areas;
  std::vector<int> labels;
  for (const Observation& look : looks) {
    if (!look.bag_seen || look.A_bag < kFlatShare * largest) continue;
    if (look.bag_at_border) {
      throw InputError(
          "calibration: the bag lies across the edge of the region of interest; lay it inside");
    }
    areas.push_back(look.A_bag);
    labels.push_back(static_cast<int>(look.labels.size()));
  }
  if (static_cast<int>(areas.size()) < kLeastFlatLooks) {
    throw InputError("calibration: " + std::to_string(areas.size()) + " of " +
                     std::to_string(looks.size()) + " frames show the bag laid flat, at least " +
                     std::to_string(kLeastFlatLooks) + " must");
  }
  Calibration found;
  found.flat_looks = static_cast<int>(areas.size());
  found.labels_seen = Median(labels);
  if (found.labels_seen < kLabelsOfMouth) {
    throw InputError("calibration: the flat bag shows " + std::to_string(found.labels_seen) +
                     " labels, at least " + std::to_string(kLabelsOfMouth) +
                     " must be seen (perception.label_hsv_min, label_hsv_max)");
  }
  const BagThresholds bag1;
  BagThresholds& t = found.thresholds;
  t.A_flat = std::round(Median(areas));
  const auto like_bag1 = [&](double area) { return std::round(area / bag1.A_flat * t.A_flat); };
  t.A_th = like_bag1(bag1.A_th);
  t.A_oth = like_bag1(bag1.A_oth);
  t.A_bmax = like_bag1(bag1.A_bmax);
  t.A_omax = like_bag1(bag1.A_omax);
  t.labels_per_layer = labels_per_layer;
  return found;
}

}  // namespace gusset
