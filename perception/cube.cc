#include "perception/cube.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "perception/depth.h"
#include "perception/shapes.h"

namespace gusset {
namespace {

/// Pixels this far (mm) from the top's median depth still count as top: three sigma of the depth
/// noise, or a top tilted by ten degrees. More would take in the upper end of the side faces.
constexpr double kTopBand_mm = 5;
/// Width of the ring around the cube in which cloth is looked for; wider than its soft edge.
constexpr int kRing_px = 6;
constexpr double kMaxElongation = 2.5;
constexpr double kMinFilled = 0.6;

bool IsCompact(const std::vector<cv::Point>& contour, double area_px2) {
  const cv::Size2f size = cv::minAreaRect(contour).size;
  // The rectangle joins pixel centres; a pixel row more covers the pixels themselves.
  const double longer = std::max(size.width, size.height) + 1;
  const double shorter = std::min(size.width, size.height) + 1;
  return longer <= kMaxElongation * shorter && area_px2 >= kMinFilled * longer * shorter;
}

bool IsAmidCloth(const std::vector<cv::Point>& contour, const ColorMasks& masks, const View& view) {
  cv::Rect box = cv::boundingRect(contour);
  box -= cv::Point(kRing_px, kRing_px);
  box += cv::Size(2 * kRing_px, 2 * kRing_px);
  cv::Mat ring;
  const cv::Mat inner = FilledContour(contour, box);
  cv::dilate(inner, ring,
             cv::getStructuringElement(cv::MORPH_RECT, {2 * kRing_px + 1, 2 * kRing_px + 1}));
  ring &= ~inner;
  const cv::Rect seen = box & view.roi;
  if (seen.empty()) return false;
  const cv::Rect in_roi = seen - view.roi.tl();
  const cv::Mat cloth = (masks.cloth(in_roi) | masks.label(in_roi)) & ring(seen - box.tl());
  return 2 * cv::countNonZero(cloth) > cv::countNonZero(ring);
}

/// Angle in [-pi/4, pi/4) that differs from the given one by quarter turns.
double WithinQuarter(double angle_rad) {
  constexpr double kQuarter = std::numbers::pi / 2;
  return angle_rad - kQuarter * std::floor(angle_rad / kQuarter + 0.5);
}

double YawOf(const std::vector<cv::Point>& face, const View& view, double height_m) {
  const cv::RotatedRect rect = cv::minAreaRect(face);
  const double angle = rect.angle * std::numbers::pi / 180;
  const cv::Point2d from(rect.center);
  const cv::Point2d to = from + cv::Point2d(std::cos(angle), std::sin(angle));
  const Eigen::Vector3d edge_W = OntoLevel(view, to, height_m) - OntoLevel(view, from, height_m);
  return WithinQuarter(std::atan2(edge_W.y(), edge_W.x()));
}

}  // namespace

std::optional<CubeBlob> FindCube(const ColorMasks& masks, const View& view,
                                 const PerceptionConfig& config) {
  cv::Rect around = cv::boundingRect(masks.cube);
  if (around.empty()) return std::nullopt;
  // A fold of cloth may lie across the cube. OpenCV does not erode at an image's edge, so the part
  // that is closed keeps a margin where there is one.
  static const cv::Mat kFold = cv::getStructuringElement(cv::MORPH_RECT, {7, 7});
  around += cv::Size(14, 14);
  around -= cv::Point(7, 7);
  around &= cv::Rect({0, 0}, masks.cube.size());
  cv::Mat red;
  cv::morphologyEx(masks.cube(around), red, cv::MORPH_CLOSE, kFold);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(red, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE, around.tl());
  std::optional<CubeBlob> largest;
  for (std::vector<cv::Point>& contour : contours) {
    const cv::Rect box = cv::boundingRect(contour);
    if (box.area() < config.cube_min_px2) continue;
    const double area = cv::countNonZero(FilledContour(contour, box));
    if (area < config.cube_min_px2 || area > config.cube_max_px2) continue;
    if (largest && area <= largest->area_px2) continue;
    if (!IsCompact(contour, area)) continue;
    largest = CubeBlob{std::move(contour), area, false};
  }
  if (largest) largest->amid_cloth = IsAmidCloth(largest->contour, masks, view);
  return largest;
}

CubeSeen LocateCube(const CubeBlob& blob, const View& view, const PerceptionConfig& config) {
  const cv::Rect box = cv::boundingRect(blob.contour);
  cv::Mat face = FilledContour(blob.contour, box);
  double top_m = config.table_height_m + config.cube_side_m;
  double centre_m = config.table_height_m + config.cube_side_m / 2;

  CubeSeen cube;
  cube.area_px2 = blob.area_px2;
  std::optional<double> top_depth_mm;
  if (!view.frame.depth_mm.empty()) {
    const cv::Mat depth = view.frame.depth_mm(box);
    std::vector<std::uint16_t> depths;
    for (int y = 0; y < box.height; ++y) {
      for (int x = 0; x < box.width; ++x) {
        if (face.at<uchar>(y, x) != 0) depths.push_back(depth.at<std::uint16_t>(y, x));
      }
    }
    top_depth_mm = MedianDepth(std::move(depths), config);
    if (top_depth_mm) {
      cv::Mat at_top;
      cv::inRange(depth, *top_depth_mm - kTopBand_mm, *top_depth_mm + kTopBand_mm, at_top);
      face &= at_top;
    }
  }
  const cv::Moments moments = cv::moments(face, /*binaryImage=*/true);
  cube.px =
      cv::Point2d(box.tl()) + cv::Point2d(moments.m10 / moments.m00, moments.m01 / moments.m00);
  cube.in_roi = view.roi.contains(cv::Point(cvRound(cube.px.x), cvRound(cube.px.y)));
  cube.from_depth = top_depth_mm.has_value();
  if (top_depth_mm) {
    const Eigen::Vector3d top_W = view.camera.Deproject(cube.px, *top_depth_mm / 1000);
    top_m = top_W.z();
    cube.p_W = top_W - Eigen::Vector3d(0, 0, config.cube_side_m / 2);
  } else {
    cube.p_W = OntoLevel(view, cube.px, centre_m);
  }
  std::vector<cv::Point> face_pixels;
  cv::findNonZero(face, face_pixels);
  for (cv::Point& pixel : face_pixels) pixel += box.tl();
  cube.yaw_rad = YawOf(face_pixels, view, top_m);
  return cube;
}

}  // namespace gusset
