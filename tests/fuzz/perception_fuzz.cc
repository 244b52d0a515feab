// libFuzzer: whatever perception's public functions are given, they answer or throw InputError.
// cmake --preset release -DCMAKE_CXX_COMPILER=clang++ -DGUSSET_FUZZ=ON; build/fuzz_perception

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/error.h"
#include "perception/bag_body.h"
#include "perception/calibrate.h"
#include "perception/color_masks.h"
#include "perception/cube.h"
#include "perception/depth.h"
#include "perception/labels.h"
#include "perception/mouth_by_depth.h"
#include "perception/mouth_outline.h"
#include "perception/opening_area.h"
#include "perception/outline.h"
#include "perception/overlay.h"
#include "perception/perceive.h"
#include "perception/pose_points.h"
#include "perception/rim.h"
#include "perception/shapes.h"
#include "perception/state.h"
#include "perception/view.h"

namespace gusset {
namespace {

/// Reads numbers off the fuzzer's bytes; zeros when they are used up.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  std::uint8_t Byte() { return at_ < size_ ? data_[at_++] : 0; }
  int Below(int n) {
    const int high = Byte();  // in this order with every compiler, or no crash could be replayed
    return (high * 256 + Byte()) % n;
  }
  /// Any double, NaN and infinities included, or a number of pixels.
  double Number() {
    if (Byte() % 8 != 0) return Below(65536) / 64.0 - 100;
    double value = 0;
    std::uint8_t raw[sizeof value];
    for (std::uint8_t& byte : raw) byte = Byte();
    std::memcpy(&value, raw, sizeof value);
    return value;
  }
  cv::Point2d Point() {
    const double x = Number();
    return {x, Number()};
  }
  std::vector<cv::Point2d> Points() {
    std::vector<cv::Point2d> points(static_cast<std::size_t>(Below(24)));
    for (cv::Point2d& point : points) point = Point();
    return points;
  }
  /// Any size from 0x0 and any type; what is left of the bytes again and again.
  cv::Mat Image() {
    static const cv::Size kSizes[] = {{0, 0}, {1, 1}, {640, 480}, {340, 340}, {3, 500}, {64, 48}};
    const int kind = Below(9);
    const cv::Size size = kind < 6 ? kSizes[kind] : cv::Size(Below(200), Below(200));
    static const int kTypes[] = {CV_8UC3, CV_8UC1, CV_16UC1, CV_32FC1, CV_8UC4, CV_64FC2};
    const int pick = Below(16);
    cv::Mat image = cv::Mat::zeros(size, kTypes[pick < 6 ? pick : pick % 3]);
    const std::size_t rest = size_ - at_;
    if (image.empty() || rest == 0) return image;
    const std::size_t bytes = image.total() * image.elemSize();
    for (std::size_t k = 0; k < bytes; ++k) image.data[k] = data_[at_ + (k / 7) % rest];
    return image;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_, at_ = 0;
};

template <class T>
std::vector<cv::Point_<T>> As(const std::vector<cv::Point2d>& points) {
  std::vector<cv::Point_<T>> converted;
  for (const cv::Point2d& p : points) {
    // Whole pixels only hold what fits.
    const bool fits = std::abs(p.x) < 1e9 && std::abs(p.y) < 1e9;
    if (fits || std::is_floating_point_v<T>) {
      converted.emplace_back(static_cast<T>(p.x), static_cast<T>(p.y));
    }
  }
  return converted;
}

void CallOne(Bytes bytes) {
  PerceptionConfig config;
  const int which = bytes.Below(20);
  switch (which) {
    case 0:
    case 1:
    case 2: {
      RgbdFrame frame;
      frame.color = bytes.Image();
      if (bytes.Byte() % 2 == 0) frame.depth_mm = bytes.Image();
      CameraModel camera = OverheadCamera({}, 1.066);
      if (bytes.Byte() % 4 == 0) camera.pinhole.fx = bytes.Number();
      if (bytes.Byte() % 4 == 0) camera.X_WC.translation().z() = bytes.Number();
      if (which == 2) config.mouth = "depth";
      const Observation seen = Perceive(frame, camera, config, BagThresholds());
      (void)DrawOverlay(frame, seen);
      (void)CalibrateThresholds({seen, seen, seen}, 5);
      return;
    }
    case 3:
      (void)DrawOverlay({bytes.Image(), {}}, Observation());
      return;
    case 4:
      (void)FindBag(bytes.Image(), config);
      return;
    case 5: {
      const cv::Mat first = bytes.Image();
      (void)FindLabels(first, bytes.Byte() % 2 == 0 ? first : bytes.Image(), bytes.Below(20),
                       config);
      return;
    }
    case 6:
      (void)MeasureOpening(bytes.Points());
      return;
    case 7: {
      const std::vector<cv::Point2d> points = bytes.Points();
      (void)UpperRightCorner(FitOutline(As<float>(points)));
      (void)SideTowards(FitOutline(As<int>(points)), bytes.Point());
      return;
    }
    case 8: {
      std::vector<cv::Point2d> points = bytes.Points();
      SnapOnto(bytes.Image(), {bytes.Below(300), bytes.Below(300)}, bytes.Below(20), points);
      return;
    }
    case 9:
      (void)RimDirection(bytes.Image(), bytes.Points(), {bytes.Below(300), 0}, bytes.Below(50));
      return;
    case 10: {
      const std::vector<cv::Point2d> points = bytes.Points();
      (void)CornersFromRow(FitOutline(As<float>(points)), points, bytes.Point(), 4);
      return;
    }
    case 11: {
      View view;
      view.frame.depth_mm = cv::Mat(bytes.Below(50), bytes.Below(50), CV_16UC1, cv::Scalar(1000));
      (void)Deproject(view, bytes.Point(), config);
      return;
    }
    case 12: {
      const cv::Mat color = bytes.Image();
      const cv::Mat depth = bytes.Image();
      (void)FindLipPoints(color, bytes.Byte() % 2 == 0 ? depth : cv::Mat(), bytes.Image(),
                          bytes.Below(40), config);
      return;
    }
    case 13: {
      const std::vector<cv::Point2d> outline = MouthOutline(bytes.Points());
      const MouthDepth depth = DepthWithin(
          outline, {bytes.Below(300), bytes.Below(300), bytes.Below(400), bytes.Below(400)});
      (void)RoomWithin(depth, bytes.Number());
      (void)MeasureWidth(outline, depth);
      (void)GoesRound(outline);
      (void)ShareOutside(depth, bytes.Image(), {bytes.Below(400), bytes.Below(400)});
      return;
    }
    case 14: {
      const RgbdFrame frame = {bytes.Image(), bytes.Byte() % 2 == 0 ? bytes.Image() : cv::Mat()};
      CameraModel camera = OverheadCamera({}, 1.066);
      if (bytes.Byte() % 4 == 0) camera.pinhole.fy = bytes.Number();
      const View view = MakeView(frame, camera, config);
      const ColorMasks masks = ThresholdColors(view, config);
      (void)CubeWidth(view, config);
      if (const auto blob = FindCube(masks, view, config)) {
        (void)LocateCube(*blob, masks, view, config);
      }
      (void)DepthAt(view, bytes.Point(), config);
      (void)OntoLevel(view, bytes.Point(), bytes.Number());
      return;
    }
    case 15: {
      const cv::Mat color = bytes.Image();
      const cv::Mat depth = bytes.Byte() % 2 == 0 ? bytes.Image() : cv::Mat();
      const cv::Mat bag = bytes.Image();
      (void)FindHem(color, depth, bag, config);
      return;
    }
    case 16: {
      std::vector<std::uint16_t> depths(static_cast<std::size_t>(bytes.Below(30)));
      for (std::uint16_t& depth : depths) depth = static_cast<std::uint16_t>(bytes.Below(65536));
      (void)MedianDepth(depths, config);
      (void)ScaleToView(bytes.Image(), bytes.Below(2000) - 5);
      return;
    }
    case 17: {
      const Quad quad = {bytes.Point(), bytes.Point(), bytes.Point(), bytes.Point()};
      (void)GridPoint(quad, bytes.Number(), bytes.Number());
      (void)RimPoints(quad, bytes.Below(40) - 5);
      (void)EdgePoints(As<int>(bytes.Points()), {bytes.Below(300), 0}, bytes.Point(),
                       CellCentres(quad, bytes.Below(12) - 2), bytes.Number(), bytes.Number(), 3);
      return;
    }
    case 18: {
      std::vector<cv::Point2d> points = bytes.Points();
      (void)FilledContour(As<int>(points), {bytes.Below(300), 0, bytes.Below(400), 50});
      (void)LongerAxis(bytes.Number(), bytes.Number(), bytes.Number());
      if (!points.empty()) (void)FitLine(points);
      std::erase_if(points, [](const cv::Point2d& p) { return std::isnan(p.x + p.y); });
      SortByXThenY(points);
      return;
    }
    case 19: {
      Evidence evidence;
      evidence.has_surroundings = bytes.Byte() % 2 == 0;
      evidence.bag_seen = bytes.Byte() % 2 == 0;
      evidence.cube_seen = bytes.Byte() % 2 == 0;
      evidence.cube_in_roi = bytes.Byte() % 2 == 0;
      evidence.cube_in_mouth = bytes.Byte() % 2 == 0;
      evidence.cube_on_bag = bytes.Byte() % 2 == 0;
      evidence.labels_seen = bytes.Below(30) - 3;
      evidence.A_bag = bytes.Number();
      evidence.A_o = bytes.Number();
      (void)StateName(ClassifyState(evidence, BagThresholds()).state);
      const CameraModel camera = OverheadCamera({}, bytes.Number());
      (void)camera.Project({bytes.Number(), bytes.Number(), bytes.Number()});
      (void)camera.Deproject(bytes.Point(), bytes.Number());
      (void)camera.OntoPlane(bytes.Point(), bytes.Number());
      return;
    }
  }
}

}  // namespace
}  // namespace gusset

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    gusset::CallOne({data, size});
  } catch (const gusset::InputError&) {  // the clear error that is asked for
  }
  return 0;
}
