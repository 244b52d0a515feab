#pragma once

#include <cstdint>
#include <string>

#include "perception/camera_model.h"
#include "sim/cloth/cloth.h"

namespace gusset {

/// How a folded start was made.
enum class FoldKind { kFolds, kDrop, kPush };

/// One start: the cloth at rest.
struct Start {
  ClothState cloth;
  FoldKind kind = FoldKind::kFolds;
  int attempts = 1;  ///< Until one hid the mouth and had the area asked for.
  int area_px = 0;   ///< As LookAtBag counts it.
};

/// What a folded start must look like.
struct StartConfig {
  int folded_area_min_px = 7000;
  int folded_area_max_px = 15000;
  int label_seen_px = 12;      ///< A label counts as seen from this many pixels.
  int mouth_labels = 3;        ///< The mouth is hidden while fewer labels are seen.
  double centre_m = 0.03;      ///< Spread of the bag's centre.
  double yaw_deg = 20;         ///< Spread of an unfolded bag's yaw.
  double any_centre_m = 0.06;  ///< The same for `--pose any`, whose yaw is free.

  template <class V>
  void Fields(V& v) {
    v("folded_area_min_px", folded_area_min_px, Range{100, 200000});
    v("folded_area_max_px", folded_area_max_px, Range{100, 200000});
    v("label_seen_px", label_seen_px, Range{1, 1000});
    v("mouth_labels", mouth_labels, Range{1, 40});
    v("centre_m", centre_m, Range{0, 0.2});
    v("yaw_deg", yaw_deg, Range{0, 180});
    v("any_centre_m", any_centre_m, Range{0, 0.2});
  }
};

/// A folded bag, made by physics as a person would: two or three folds along random lines; or
/// gathered at a random point and dropped from 0.3 m; or dropped, then pushed together from four
/// sides. The three are equally likely. Attempts are made until one hides the mouth and has the
/// area; nothing else is chosen. A function of its arguments alone.
/// @throws RunError if no attempt out of 300 serves. Interrupted (base/stop.h).
Start MakeFoldedStart(const BagConfig& bag, const ClothSolverConfig& solver,
                      const StartConfig& config, const CameraModel& camera, bool any_pose,
                      std::uint64_t seed);

/// A bag laid flat, either side up, and left until it is at rest.
Start MakeUnfoldedStart(const BagConfig& bag, const ClothSolverConfig& solver,
                        const StartConfig& config, const CameraModel& camera, bool any_pose,
                        std::uint64_t seed);

}  // namespace gusset
