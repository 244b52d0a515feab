#include "perception/state.h"

#include <array>

namespace gusset {

std::string_view StateName(State state) {
  static constexpr std::array<std::string_view, 6> kNames = {"s0", "s1", "s2", "s3", "s4", "s5"};
  return kNames.at(static_cast<std::size_t>(state));
}

Classified ClassifyState(const Evidence& evidence, const BagThresholds& thresholds) {
  const bool mouth_seen = evidence.labels_seen >= kLabelsOfMouth;
  if (!evidence.bag_seen) return {evidence.cube_in_roi ? State::kFail : State::kSuccess};
  if (evidence.cube_in_roi && (evidence.cube_in_mouth || (evidence.cube_on_bag && !mouth_seen))) {
    return {State::kFilled};
  }
  if (evidence.has_surroundings && !evidence.cube_seen) {
    return {State::kFilled, /*cube_hidden=*/true};
  }
  if (mouth_seen && evidence.A_o > thresholds.A_oth &&
      evidence.A_bag > kOpenBagShare * thresholds.A_flat) {
    return {State::kOpen};
  }
  if (!(evidence.A_bag > thresholds.A_th) || !mouth_seen) return {State::kFolded};
  return {State::kUnfolded};
}

}  // namespace gusset
