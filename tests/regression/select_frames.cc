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

// How far, relatively, a frame is from the nearest threshold that its state knows.
double Distance(const LabelledFrame& frame, const BagThresholds& t) {
  const auto to = [](double area, double threshold) { return std::abs(area / threshold - 1); };
  switch (frame.state) {
    case State::kFolded:
    case State::kUnfolded:
      return std::min(to(frame.A_bag, t.A_th), to(frame.A_o, t.A_oth));
    case State::kOpen:
      return std::min(to(frame.A_bag, kOpenBagShare * t.A_flat), to(frame.A_o, t.A_oth));
    default:
      return 1;  // areas decide nothing
  }
}

void Select(int per_state, const std::vector<std::string>& corpora) {
  std::vector<StoredFrame> chosen;
  MakeFolder(StoredFramesFolder());
  for (const std::string& corpus : corpora) {
    const std::filesystem::path folder = corpus;
    const std::string bag = folder.filename();
    ConfigTree tree;
    tree.Load(AssetsFolder() / "bags" / (bag + ".toml"));
    BaggingConfig config;
    config.Read(tree);
    // By state, nearest to a threshold first; one frame of a world.
    std::map<State, std::multimap<double, LabelledFrame>> frames;
    std::set<std::string> worlds;
    for (const LabelledFrame& frame : ReadLabels(folder)) {
      const double distance = Distance(frame, config.chosen_thresholds());
      if (distance < kLeastMargin || !worlds.insert(frame.world).second) continue;
      frames[frame.state].emplace(distance, frame);
    }
    for (const auto& [state, nearest] : frames) {
      int count = 0;
      for (const auto& [distance, frame] : nearest) {
        if (count == per_state) break;
        const std::string name =
            bag + "_" + std::string(StateName(state)) + "_" + std::to_string(count++);
        std::vector<uchar> bytes;
        cv::imencode(".jpg", ReadImage(frame.color, cv::IMREAD_COLOR), bytes,
                     {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
        WriteFileAtomic(StoredFramesFolder() / (name + ".jpg"),
                        {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
        const StoredFrame stored = {name, bag, std::string(StateName(state)), nullptr};
        // A set that fails from the start guards nothing; what is seen wrong is for the corpus to
        // show.
        if (StateName(LookAtStored(stored).seen.state) != stored.state) {
          std::printf("left out, seen wrong: %s\n", frame.color.c_str());
          std::filesystem::remove(StoredFramesFolder() / (name + ".jpg"));
          --count;
          continue;
        }
        chosen.push_back(stored);
        std::printf("%s: %.3f from a threshold\n", name.c_str(), distance);
      }
    }
  }
  WriteStoredFrames(chosen);
}

}  // namespace
}  // namespace gusset

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: gusset_select_frames PER_STATE CORPUS...\n");
    return 2;
  }
  try {
    gusset::Select(std::atoi(argv[1]), {argv + 2, argv + argc});
  } catch (const gusset::InputError& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 2;
  }
  return 0;
}
