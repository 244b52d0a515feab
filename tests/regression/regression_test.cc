// Stored frames must be seen as they were when last accepted (tools/accept-goldens), and, whatever
// was accepted, as what they are.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>

#include "agents/image_file.h"
#include "base/files.h"
#include "tests/regression/stored_frame.h"
#include "tools/gusset/image_input.h"

namespace gusset {
namespace {

namespace fs = std::filesystem;

/// Share, of the values that are drawn in either, that must be within kLevels: lines may be a pixel
/// off along a hundredth of them. Of all values of the image that would be next to nothing.
constexpr double kConformity = 0.99;
constexpr int kLevels = 2;
/// Points may be off by so many px, and mm of height: a pixel, where a tie was rounded otherwise.
constexpr double kOff = 1.1;

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
  for (auto x = a.begin(), y = b.begin(); x != a.end(); ++x, ++y) {
    if ((a.is_object() && x.key() != y.key()) || !Alike(*x, *y)) return false;
  }
  return true;
}

// Lines and points without the text, whose numbers are compared as such.
cv::Mat InColour(const cv::Mat& drawing) {
  cv::Mat result = drawing.clone();
  for (cv::Vec3b& pixel : cv::Mat_<cv::Vec3b>(result)) {
    if (pixel[0] == pixel[1] && pixel[1] == pixel[2]) pixel = cv::Vec3b();
  }
  return result;
}

// Of the values that are drawn in either.
double Conformity(const cv::Mat& drawing, const cv::Mat& golden) {
  const cv::Mat seen = InColour(drawing), accepted = InColour(golden);
  cv::Mat off, either;
  cv::absdiff(seen, accepted, off);
  cv::bitwise_or(seen, accepted, either);
  const int differ = cv::countNonZero(off.reshape(1) > kLevels);
  const int drawn = cv::countNonZero(either.reshape(1));
  return drawn == 0 ? 1 : 1 - static_cast<double>(differ) / drawn;
}

TEST(Alike, MindsAPointAPixelOffAndOneThatIsMissing) {
  const ordered_json golden = {{"A_bag", 30000.0},
                               {"points", {{10.0, 20.0, 1.5}, {30.0, 40.0, 1.5}}}};
  ordered_json seen = golden;
  seen["A_bag"] = 30029.0;
  seen["points"][1][0] = 31.0;
  EXPECT_TRUE(Alike(seen, golden));
  seen["points"][1][0] = 31.5;
  EXPECT_FALSE(Alike(seen, golden));
  seen = golden;
  seen.erase("A_bag");
  seen["A_o"] = 30000.0;
  EXPECT_FALSE(Alike(seen, golden));
  seen = golden;
  seen["points"].erase(1);
  EXPECT_FALSE(Alike(seen, golden));
  seen = golden;
  seen["A_bag"] = 30031.0;
  EXPECT_FALSE(Alike(seen, golden));
}

// An outline of four sides, one of which has moved; the figures beside it are another matter.
TEST(Conformity, MindsASideThatMovedAndNoFigures) {
  const auto drawing = [](int right, const char* figures) {
    cv::Mat image = cv::Mat::zeros(340, 340, CV_8UC3);
    cv::rectangle(image, cv::Point(80, 80), cv::Point(right, 280), {0, 255, 0}, 1);
    cv::putText(image, figures, {5, 320}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar::all(255), 1,
                cv::LINE_AA);
    return image;
  };
  EXPECT_EQ(Conformity(drawing(250, "34950.0"), drawing(250, "34951.0")), 1);
  EXPECT_LT(Conformity(drawing(251, "34950.0"), drawing(250, "34950.0")), kConformity);
}

TEST(StoredFrames, AreOfEveryBagInEveryState) {
  std::set<std::string> kinds;
  for (const StoredFrame& frame : ReadStoredFrames()) kinds.insert(frame.bag + " " + frame.state);
  EXPECT_EQ(kinds.size(), 5u * 6u);
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
