// Chooses the regression set from corpora that `gusset render --state all` wrote: see
// tools/make-regression-frames. Usage: gusset_select_frames PER_STATE CORPUS...

#include <cstdio>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "agents/bagging_env.h"
#include "agents/image_file.h"
#include "base/error.h"
#include "base/files.h"
#include "tests/regression/stored_frame.h"
#include "tools/gusset/corpus.h"
#include "tools/gusset/image_input.h"

namespace gusset {
namespace {

/// Small files, and hardly a pixel that falls on another side of a threshold than in the PNG.
constexpr int kJpegQuality = 92;
/// Nearer to a threshold noise decides, and a frame tests nothing.
constexpr double kLeastMargin = 0.01;
/// Bags of which frames have depth, plain and varied.
const std::set<std::string> kWithDepth = {"bag1", "large"};

// How far, relatively, a frame is from the nearest threshold that its state knows.
double Distance(const LabelledFrame& frame, const BaggingConfig& config) {
  const BagThresholds& t = config.chosen_thresholds();
  const auto to = [](double area, double threshold) { return std::abs(area / threshold - 1); };
  double nearest = 1;  // in s3 to s5 areas decide nothing
  if (frame.state == State::kFolded || frame.state == State::kUnfolded) {
    nearest = std::min(to(frame.A_bag, t.A_th), to(frame.A_o, t.A_oth));
  } else if (frame.state == State::kOpen) {
    nearest = std::min(to(frame.A_bag, kOpenBagShare * t.A_flat), to(frame.A_o, t.A_oth));
  } else {
    return nearest;
  }
  for (const LabelledFrame::Label& label : frame.shown) {
    nearest = std::min(nearest, to(label.px2, config.perception.label_min_px2));
  }
  return nearest;
}

struct Chosen {
  StoredFrame stored;
  std::vector<uchar> jpeg;
  cv::Mat depth_mm;  ///< Of the first of each state: the files are large.
};

std::vector<Chosen> ChooseFrom(const std::filesystem::path& folder, int per_state) {
  const std::string bag = folder.filename();
  ConfigTree tree;
  tree.Load(AssetsFolder() / "bags" / (bag + ".toml"));
  BaggingConfig config;
  config.Read(tree);
  // By state, nearest to a threshold first; one frame of a world.
  std::map<State, std::multimap<double, LabelledFrame>> frames;
  std::set<std::string> worlds;
  for (const LabelledFrame& frame : ReadLabels(folder)) {
    const double distance = Distance(frame, config);
    if (distance < kLeastMargin || !worlds.insert(frame.world).second) continue;
    frames[frame.state].emplace(distance, frame);
  }
  std::vector<Chosen> chosen;
  for (const auto& [state, nearest] : frames) {
    int count = 0;
    for (const auto& [distance, frame] : nearest) {
      if (count == per_state) break;
      const std::string name =
          bag + "_" + std::string(StateName(state)) + "_" + std::to_string(count);
      Chosen one = {{name, bag, std::string(StateName(state)), nullptr}, {}, {}};
      cv::imencode(".jpg", ReadImage(frame.color, cv::IMREAD_COLOR), one.jpeg,
                   {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
      if (count == 0 && kWithDepth.contains(bag)) {
        one.depth_mm = ReadImage(frame.depth, cv::IMREAD_UNCHANGED);
      }
      // A set that fails from the start guards nothing; what is seen wrong is for the corpus to
      // show.
      const RgbdFrame stored = {cv::imdecode(one.jpeg, cv::IMREAD_COLOR), one.depth_mm};
      if (LookAt(stored, bag).seen.state != state) {
        std::printf("left out, seen wrong: %s\n", frame.color.c_str());
        continue;
      }
      ++count;
      std::printf("%s: %.3f from a threshold\n", name.c_str(), distance);
      chosen.push_back(std::move(one));
    }
  }
  return chosen;
}

void Select(int per_state, const std::vector<std::string>& corpora) {
  std::vector<Chosen> chosen;
  for (const std::string& corpus : corpora) {
    for (Chosen& one : ChooseFrom(corpus, per_state)) chosen.push_back(std::move(one));
  }
  if (chosen.empty()) throw InputError("no frame to choose");
  const std::filesystem::path folder = StoredFramesFolder();
  std::filesystem::remove_all(folder);
  MakeFolder(folder);
  std::vector<StoredFrame> lines;
  for (const Chosen& one : chosen) {
    WriteFileAtomic(folder / (one.stored.name + ".jpg"),
                    {reinterpret_cast<const char*>(one.jpeg.data()), one.jpeg.size()});
    if (!one.depth_mm.empty()) WriteImage(folder / (one.stored.name + "_depth.png"), one.depth_mm);
    lines.push_back(one.stored);
  }
  WriteStoredFrames(lines);
}

}  // namespace
}  // namespace gusset

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: gusset_select_frames PER_STATE CORPUS...\n");
    return 2;
  }
  try {
    const int per_state = std::atoi(argv[1]);
    if (per_state < 1) throw gusset::InputError("PER_STATE must be 1 or more");
    gusset::Select(per_state, {argv + 2, argv + argc});
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
  return 0;
}
