#include "tests/regression/stored_frame.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "agents/bagging_env.h"
#include "agents/image_file.h"
#include "base/files.h"
#include "perception/overlay.h"
#include "tools/gusset/image_input.h"

namespace gusset {
namespace {

double Tenths(double value) { return std::round(10 * value) / 10; }

// Where the image has it, px, and how high it lies, mm.
nlohmann::ordered_json PxAndHeight(cv::Point2d px, const Eigen::Vector3d& p_W) {
  return {Tenths(px.x), Tenths(px.y), Tenths(1000 * p_W.z())};
}

}  // namespace

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

StoredLook LookAt(const RgbdFrame& frame, const std::string& bag) {
  ConfigTree tree;
  tree.Load(AssetsFolder() / "bags" / (bag + ".toml"));
  BaggingConfig config;
  config.Read(tree);
  StoredLook look;
  look.frame = frame;
  look.seen =
      Perceive(frame, OverheadCamera({}, 1.066), config.perception, config.chosen_thresholds());
  look.overlay = DrawOverlay({cv::Mat::zeros(frame.color.size(), CV_8UC3), {}}, look.seen);
  const Observation& seen = look.seen;
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (const auto* list : {&seen.grasp_points, &seen.place_points, &seen.edge_points}) {
    for (const PosePoint& point : *list) points.push_back(PxAndHeight(point.px, point.p_W));
  }
  look.golden = {{"state", StateName(seen.state)},
                 {"A_bag", seen.A_bag},
                 {"A_o", seen.A_o},
                 {"labels", seen.labels.size()},
                 {"piece", seen.piece},
                 {"cube_hidden", seen.cube_hidden},
                 {"cube", nullptr},
                 {"width", nullptr},
                 {"points", points}};
  if (seen.cube) look.golden["cube"] = PxAndHeight(seen.cube->centre_px, seen.cube->p_W);
  if (seen.width) {
    look.golden["width"] = {Tenths(seen.width->radius_px), Tenths(seen.width->length_px),
                            seen.width->closed};
  }
  return look;
}

StoredLook LookAtStored(const StoredFrame& frame) {
  const std::filesystem::path stem = StoredFramesFolder() / frame.name;
  RgbdFrame stored{ReadImage(stem.string() + ".jpg", cv::IMREAD_COLOR), {}};
  if (const std::string depth = stem.string() + "_depth.png"; std::filesystem::exists(depth)) {
    stored.depth_mm = ReadImage(depth, cv::IMREAD_UNCHANGED);
  }
  return LookAt(stored, frame.bag);
}

}  // namespace gusset
