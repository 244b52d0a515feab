#include "tests/regression/stored_frame.h"

#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "agents/bagging_env.h"
#include "agents/image_file.h"
#include "base/files.h"
#include "perception/overlay.h"
#include "tools/gusset/image_input.h"

namespace gusset {

std::filesystem::path StoredFramesFolder() {
  return std::filesystem::path(GUSSET_SOURCE_DIR) / "tests" / "data" / "frames";
}

std::vector<StoredFrame> ReadStoredFrames() {
  const std::filesystem::path file = StoredFramesFolder() / "frames.jsonl";
  std::vector<StoredFrame> frames;
  if (!std::filesystem::exists(file)) return frames;
  std::istringstream lines(ReadFile(file));
  for (std::string line; std::getline(lines, line);) {
    const auto json = nlohmann::ordered_json::parse(line);
    frames.push_back({json.at("name"), json.at("bag"), json.at("state"), json.at("golden")});
  }
  return frames;
}

void WriteStoredFrames(const std::vector<StoredFrame>& frames) {
  std::string text;
  for (const StoredFrame& frame : frames) {
    const nlohmann::ordered_json line = {
        {"name", frame.name}, {"bag", frame.bag}, {"state", frame.state}, {"golden", frame.golden}};
    text += line.dump() + "\n";
  }
  WriteFileAtomic(StoredFramesFolder() / "frames.jsonl", text);
}

StoredLook LookAtStored(const StoredFrame& frame) {
  ConfigTree tree;
  tree.Load(AssetsFolder() / "bags" / (frame.bag + ".toml"));
  BaggingConfig config;
  config.Read(tree);
  StoredLook look;
  look.color = ReadImage(StoredFramesFolder() / (frame.name + ".jpg"), cv::IMREAD_COLOR);
  look.seen = Perceive({look.color, {}}, OverheadCamera({}, 1.066), config.perception,
                       config.chosen_thresholds());
  look.overlay = DrawOverlay({cv::Mat::zeros(look.color.size(), CV_8UC3), {}}, look.seen);
  look.golden = {{"state", StateName(look.seen.state)},
                 {"A_bag", look.seen.A_bag},
                 {"A_o", look.seen.A_o},
                 {"labels", look.seen.labels.size()},
                 {"piece", look.seen.piece},
                 {"cube_hidden", look.seen.cube_hidden}};
  return look;
}

}  // namespace gusset
