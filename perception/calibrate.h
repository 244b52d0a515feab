#pragma once

#include <vector>

#include "perception/config.h"
#include "perception/observation.h"

namespace gusset {

/// What calibration found.
struct Calibration {
  BagThresholds thresholds;  ///< Its areas are new, labels_per_layer is the given one.
  int flat_looks = 0;        ///< Looks that count as the bag laid flat.
  int labels_seen = 0;       ///< Median over those.
};

/// Fewer looks at the flat bag than this are refused.
inline constexpr int kLeastFlatLooks = 3;
/// A look counts as the bag laid flat if its area is at least this share of the largest one.
inline constexpr double kFlatShare = 0.95;

/// A bag's thresholds from a handful of looks at it laid flat with its mouth closed; other looks,
/// as of folded bags, may be among them. A_flat is the median area of the flat ones, and the other
/// four follow it as Bag 1's do (Table 5.3; A_oth as in BagThresholds):
///   A_th = 25000/34950 A_flat, A_bmax = 34000/34950 A_flat,
///   A_oth = 700/34950 A_flat, A_omax = 3900/34950 A_flat.
/// @param labels_per_layer of the bag.
/// @throws InputError if fewer than kLeastFlatLooks are flat, or those do not show the mouth or lie
///   across the edge of the region of interest.
Calibration CalibrateThresholds(const std::vector<Observation>& looks, int labels_per_layer);

}  // namespace gusset
