#pragma once

#include <string_view>

#include "perception/config.h"

namespace gusset {

/// The states of Eq. 5.1; the values are the thesis's indices.
enum class State {
  kFolded = 0,    ///< s0
  kUnfolded = 1,  ///< s1
  kOpen = 2,      ///< s2
  kFilled = 3,    ///< s3: the cube is in the mouth, or out of sight.
  kSuccess = 4,   ///< s4: no bag and no cube left.
  kFail = 5,      ///< s5: the bag is gone, the cube is still there.
};

/// "s0" .. "s5".
std::string_view StateName(State state);

/// The mouth is seen when at least this many labels are.
inline constexpr int kLabelsOfMouth = 3;
/// An open bag covers more than this share of its flat area.
inline constexpr double kOpenBagShare = 0.55;

/// All that the state depends on.
struct Evidence {
  bool has_surroundings = false;  ///< A full frame, in which a cube cannot hide beside the ROI.
  bool bag_seen = false;          ///< In the ROI.
  bool cube_seen = false;         ///< Anywhere in the frame.
  bool cube_in_roi = false;       ///< Implies cube_seen.
  bool cube_in_mouth = false;     ///< Inside the labels' hull grown by one cube width.
  bool cube_on_bag = false;
  int labels_seen = 0;
  double A_bag = 0;  ///< px^2.
  double A_o = 0;    ///< px^2.
};

struct Classified {
  State state = State::kSuccess;
  bool cube_hidden = false;  ///< s3 because the cube is nowhere to be seen.
};

/// The state, in place of Eq. 5.2, which leaves gaps. Total: every Evidence has exactly one state,
/// first match wins:
///
///   bag | cube                                   | areas                         | state
///   no  | not in ROI                             |                               | s4
///   no  | in ROI                                 |                               | s5
///   yes | in ROI and (in the mouth, or on the    |                               | s3
///       | bag with the mouth not seen)           |                               |
///   yes | nowhere in a full frame                |                               | s3 (hidden)
///   yes | elsewhere, or nowhere in a bare ROI    | mouth seen, A_o > A_oth and   | s2
///       |                                        | A_bag > 0.55 A_flat           |
///       |                                        | A_bag <= A_th or no mouth     | s0
///       |                                        | otherwise                     | s1
Classified ClassifyState(const Evidence& evidence, const BagThresholds& thresholds);

}  // namespace gusset
