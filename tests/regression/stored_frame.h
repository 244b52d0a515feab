#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <ostream>
#include <string>
#include <vector>

#include "perception/observation.h"
#include "perception/rgbd_frame.h"

namespace gusset {

/// A frame of the regression set: `name`.jpg in tests/data/frames, of some `name`_depth.png, a line
/// of frames.jsonl there, and `name`_overlay.png, what perception draws over it, on black.
struct StoredFrame {
  std::string name;
  std::string bag;    ///< In assets/bags; gives the thresholds.
  std::string state;  ///< By ground truth.
  nlohmann::ordered_json
      golden;  ///< What was seen when the golden was accepted; null: nothing yet.
};

/// How GoogleTest names it.
inline void PrintTo(const StoredFrame& frame, std::ostream* out) { *out << frame.name; }

/// What perception says of a stored frame.
struct StoredLook {
  RgbdFrame frame;
  Observation seen;
  cv::Mat overlay;                ///< On black.
  nlohmann::ordered_json golden;  ///< `seen` as StoredFrame::golden.
};

std::filesystem::path StoredFramesFolder();
/// None if there is no set yet. @throws InputError or nlohmann's exceptions for a broken one.
std::vector<StoredFrame> ReadStoredFrames();
void WriteStoredFrames(const std::vector<StoredFrame>& frames);
/// @param bag in assets/bags.
StoredLook LookAt(const RgbdFrame& frame, const std::string& bag);
StoredLook LookAtStored(const StoredFrame& frame);

}  // namespace gusset
