// Stored frames must be seen as they were when last accepted (tools/accept-goldens), and, whatever
// was accepted, as what they are.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "agents/image_file.h"
#include "base/files.h"
#include "tests/regression/stored_frame.h"
#include "tools/gusset/image_input.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

/// Share of values that may differ by more than kLevels (house rule 17): a line one pixel off along
/// a sixth of the outline is as much.
constexpr double kConformity = 0.995;
constexpr int kLevels = 2;

bool Accepting() { return std::getenv("GUSSET_ACCEPT_GOLDENS") != nullptr; }

class Regression : public testing::TestWithParam<StoredFrame> {};

// The same but for a thousandth of an area, which is more than rounding and less than anyone minds.
bool Alike(nlohmann::ordered_json a, nlohmann::ordered_json b) {
  for (const char* area : {"A_bag", "A_o"}) {
    const double x = a.at(area), y = b.at(area);
    if (std::abs(x - y) > 1e-3 * std::max(x, y)) return false;
    a.erase(area);
    b.erase(area);
  }
  return a == b;
}

cv::Mat OverFrame(const cv::Mat& color, const cv::Mat& drawing, const cv::Rect& roi) {
  cv::Mat picture = color(roi).clone();
  cv::Mat drawn;
  cv::cvtColor(drawing, drawn, cv::COLOR_BGR2GRAY);
  drawing.copyTo(picture, drawn > 0);
  return picture;
}

// Writes what was drawn, what it should be and where they differ. @returns a text that names them.
std::string WriteDifference(const StoredFrame& frame, const StoredLook& look,
                            const cv::Mat& golden) {
  const fs::path folder = fs::path(testing::TempDir()) / "gusset_regression";
  MakeFolder(folder);
  const auto path = [&](const char* what) { return folder / (frame.name + "_" + what + ".png"); };
  WriteImage(path("new"), OverFrame(look.color, look.overlay, look.seen.roi));
  WriteImage(path("golden"), OverFrame(look.color, golden, look.seen.roi));
  cv::Mat difference;
  cv::absdiff(look.overlay, golden, difference);
  WriteImage(path("difference"), difference);
  return "new image " + path("new").string() + "\ngolden " + path("golden").string() +
         "\ndifference " + path("difference").string() + "\nto accept: tools/accept-goldens";
}

TEST_P(Regression, IsSeenAsItIs) {
  const StoredFrame& frame = GetParam();
  EXPECT_EQ(StateName(LookAtStored(frame).seen.state), frame.state) << frame.name;
}

TEST_P(Regression, IsSeenAsAccepted) {
  const StoredFrame& frame = GetParam();
  const StoredLook look = LookAtStored(frame);
  const fs::path file = StoredFramesFolder() / (frame.name + "_overlay.png");
  if (Accepting()) {
    WriteImage(file, look.overlay);
    std::vector<StoredFrame> frames = ReadStoredFrames();
    for (StoredFrame& other : frames) {
      if (other.name == frame.name) other.golden = look.golden;
    }
    WriteStoredFrames(frames);
    return;
  }
  ASSERT_FALSE(frame.golden.is_null()) << "nothing accepted yet: tools/accept-goldens";
  const cv::Mat golden = ReadImage(file, cv::IMREAD_COLOR);
  ASSERT_EQ(golden.size(), look.overlay.size());
  cv::Mat off;
  cv::absdiff(look.overlay, golden, off);
  const cv::Mat values = off.reshape(1);
  const double conformity =
      1 - cv::countNonZero(values > kLevels) / static_cast<double>(values.total());
  const bool numbers = Alike(look.golden, frame.golden);
  if (conformity < kConformity || !numbers) {
    FAIL() << frame.name << ": " << 100 * conformity << " % of values within " << kLevels << ", "
           << "seen " << look.golden.dump() << ", accepted " << frame.golden.dump() << "\n"
           << WriteDifference(frame, look, golden);
  }
}

INSTANTIATE_TEST_SUITE_P(StoredFrames, Regression, testing::ValuesIn(ReadStoredFrames()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace gusset
