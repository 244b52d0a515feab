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

/// Share, of the values that are drawn in either, that must be within kLevels: a line may be a
/// pixel off along a hundredth of what is drawn. Of all values of the image it would be next to
/// nothing.
constexpr double kConformity = 0.99;
constexpr int kLevels = 2;
/// Points may be off by so many px, and mm of height: rounding to a pixel, once.
constexpr double kOff = 0.6;

bool Accepting() { return std::getenv("GUSSET_ACCEPT_GOLDENS") != nullptr; }

class Regression : public testing::TestWithParam<StoredFrame> {};

using nlohmann::ordered_json;

// Numbers within kOff or, of what is larger (areas), a thousandth; all else the same.
bool Alike(const ordered_json& a, const ordered_json& b) {
  if (a.is_number() && b.is_number()) {
    const double x = a, y = b;
    return std::abs(x - y) <= std::max(kOff, 1e-3 * std::max(std::abs(x), std::abs(y)));
  }
  if (!a.is_structured() || !b.is_structured()) return a == b;
  if (a.type() != b.type() || a.size() != b.size()) return false;
  return std::equal(a.begin(), a.end(), b.begin(), Alike);
}

// Of the values that are drawn in either.
double Conformity(const cv::Mat& drawing, const cv::Mat& golden) {
  cv::Mat off, either;
  cv::absdiff(drawing, golden, off);
  cv::bitwise_or(drawing, golden, either);
  const int differ = cv::countNonZero(off.reshape(1) > kLevels);
  const int drawn = cv::countNonZero(either.reshape(1));
  return drawn == 0 ? 1 : 1 - static_cast<double>(differ) / drawn;
}

TEST(Alike, MindsAPointAPixelOffAndOneThatIsMissing) {
  const ordered_json golden = {{"A_bag", 30000.0},
                               {"points", {{10.0, 20.0, 1.5}, {30.0, 40.0, 1.5}}}};
  ordered_json seen = golden;
  seen["A_bag"] = 30029.0;
  seen["points"][1][0] = 30.5;
  EXPECT_TRUE(Alike(seen, golden));
  seen["points"][1][0] = 31.0;
  EXPECT_FALSE(Alike(seen, golden));
  seen = golden;
  seen["points"].erase(1);
  EXPECT_FALSE(Alike(seen, golden));
  seen = golden;
  seen["A_bag"] = 30031.0;
  EXPECT_FALSE(Alike(seen, golden));
}

TEST(Conformity, MindsAPointOfNine) {
  cv::Mat golden = cv::Mat::zeros(340, 340, CV_8UC3);
  cv::rectangle(golden, {80, 80, 170, 200}, {0, 255, 0}, 2);
  cv::Mat seen = golden.clone();
  cv::circle(golden, {150, 200}, 3, {0, 0, 255}, cv::FILLED);
  EXPECT_EQ(Conformity(golden, golden), 1);
  EXPECT_LT(Conformity(seen, golden), kConformity);
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
  WriteImage(path("new"), OverFrame(look.frame.color, look.overlay, look.seen.roi));
  WriteImage(path("golden"), OverFrame(look.frame.color, golden, look.seen.roi));
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
  const double conformity = Conformity(look.overlay, golden);
  const bool numbers = Alike(look.golden, frame.golden);
  if (conformity < kConformity || !numbers) {
    FAIL() << frame.name << ": " << 100 * conformity << " % of what is drawn within " << kLevels
           << ", "
           << "seen " << look.golden.dump() << ", accepted " << frame.golden.dump() << "\n"
           << WriteDifference(frame, look, golden);
  }
}

INSTANTIATE_TEST_SUITE_P(StoredFrames, Regression, testing::ValuesIn(ReadStoredFrames()),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace gusset
