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
/// Less of a cube than this share of its top is covered, if cloth is beside it.
constexpr double kMostCovered = 0.75;
/// A cube stands beside cloth if that is this share of the ring: the side of a square that lies
/// along cloth has a quarter of it, a corner stuck out of it more.
constexpr double kBesideCloth = 0.15;
/// Squares that hold so few pixels less are as good.
constexpr float kAsGood_px2 = 3;

double Length(const std::vector<cv::Point>& contour) {
  const cv::Size2f size = cv::minAreaRect(contour).size;
  return std::max(size.width, size.height) + 1;
}

/// The longest that a cube may show there: the diagonal of its top, which is nearer than the table,
/// and as much of a side as leans out beside it. Soft edges add a pixel.
double LongestOfCube(const std::vector<cv::Point>& contour, const View& view,
                     const PerceptionConfig& config) {
  const double side_m = config.cube_side_m;
  const double below_m = view.camera.X_WC.translation().z() - config.table_height_m - side_m;
  const double nearer = side_m / std::max(below_m, config.depth_min_m);
  const cv::Rect box = cv::boundingRect(contour);
  const Pinhole& pinhole = view.camera.pinhole;
  const double out_px =
      std::hypot(box.x + 0.5 * box.width - pinhole.cx, box.y + 0.5 * box.height - pinhole.cy);
  return std::numbers::sqrt2 * CubeWidth(view, config) * (1 + nearer) + out_px * nearer + 1;
}

bool IsCompact(const std::vector<cv::Point>& contour, double area_px2) {
  const cv::Size2f size = cv::minAreaRect(contour).size;
  // The rectangle joins pixel centres; a pixel row more covers the pixels themselves.
  const double longer = std::max(size.width, size.height) + 1;
  const double shorter = std::min(size.width, size.height) + 1;
  return longer <= kMaxElongation * shorter && area_px2 >= kMinFilled * longer * shorter;
}

/// How much of a ring round the cube is cloth or label, 0 to 1.
double ClothAround(const std::vector<cv::Point>& contour, const ColorMasks& masks,
                   const View& view) {
  cv::Rect box = cv::boundingRect(contour);
  box -= cv::Point(kRing_px, kRing_px);
  box += cv::Size(2 * kRing_px, 2 * kRing_px);
  cv::Mat ring;
  const cv::Mat inner = FilledContour(contour, box);
  cv::dilate(inner, ring,
             cv::getStructuringElement(cv::MORPH_RECT, {2 * kRing_px + 1, 2 * kRing_px + 1}));
  ring &= ~inner;
  const cv::Rect seen = box & view.roi;
  if (seen.empty()) return 0;
  const cv::Rect in_roi = seen - view.roi.tl();
  const cv::Mat cloth = (masks.cloth(in_roi) | masks.label(in_roi)) & ring(seen - box.tl());
  return static_cast<double>(cv::countNonZero(cloth)) / cv::countNonZero(ring);
}

/// A square about the middle of an image just large enough for it; 1 inside, 0 outside.
cv::Mat Square(double width_px, double yaw_deg) {
  const int reach = static_cast<int>(std::ceil(width_px / std::numbers::sqrt2));
  cv::Mat square = cv::Mat::zeros(2 * reach + 1, 2 * reach + 1, CV_32F);
  const auto middle = static_cast<float>(reach);
  const auto width = static_cast<float>(width_px);
  const cv::RotatedRect rect({middle, middle}, {width, width}, static_cast<float>(yaw_deg));
  std::vector<cv::Point2f> corners(4);
  rect.points(corners.data());
  const std::vector<cv::Point> rounded(corners.begin(), corners.end());
  cv::fillConvexPoly(square, rounded, 1);
  return square;
}

/// Centre of a cube that cloth leaves only a part of; see LocateCube. None if there is not cloth
/// enough to hide the rest: every square then holds more canvas than cube.
std::optional<cv::Point2d> CentreOfCovered(const CubeBlob& blob, const ColorMasks& masks,
                                           const View& view, double width_px) {
  const int margin = static_cast<int>(std::ceil(width_px * 1.5));
  cv::Rect box = cv::boundingRect(blob.contour);
  box -= cv::Point(margin, margin);
  box += cv::Size(2 * margin, 2 * margin);
  const cv::Mat cube = FilledContour(blob.contour, box);
  cv::Mat hides = cv::Mat::zeros(box.size(), CV_8UC1);
  if (const cv::Rect seen = box & view.roi; !seen.empty()) {
    const cv::Rect in_roi = seen - view.roi.tl();
    cv::Mat(masks.cloth(in_roi) | masks.label(in_roi)).copyTo(hides(seen - box.tl()));
  }
  // Where cube and cloth meet, a soft edge has the colour of neither.
  cv::Mat either;
  cv::dilate(hides | cube, either, cv::getStructuringElement(cv::MORPH_RECT, {3, 3}));
  cv::Mat gain(box.size(), CV_32F, cv::Scalar(-1));
  gain.setTo(0, either);
  gain.setTo(1, cube);

  constexpr double kYawStep_deg = 10;
  std::vector<std::pair<float, cv::Point2d>> placements;
  float best = 0;
  for (double yaw_deg = 0; yaw_deg < 90; yaw_deg += kYawStep_deg) {
    const cv::Mat square = Square(width_px, yaw_deg);
    cv::Mat score;
    cv::matchTemplate(gain, square, score, cv::TM_CCORR);
    for (int y = 0; y < score.rows; ++y) {
      for (int x = 0; x < score.cols; ++x) {
        const float at = score.at<float>(y, x);
        best = std::max(best, at);
        if (at > best - kAsGood_px2) placements.emplace_back(at, cv::Point2d(x, y));
      }
    }
  }
  if (best <= 0) return std::nullopt;
  const int reach = static_cast<int>(std::ceil(width_px / std::numbers::sqrt2));
  cv::Point2d sum(0, 0);
  int count = 0;
  for (const auto& [at, corner] : placements) {
    if (at <= best - kAsGood_px2) continue;
    sum += corner;
    ++count;
  }
  return cv::Point2d(box.tl()) + cv::Point2d(reach, reach) + sum / count;
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

double CubeWidth(const View& view, const PerceptionConfig& config) {
  const double distance_m = std::abs(view.camera.X_WC.translation().z() - config.table_height_m);
  return view.camera.pinhole.fx * config.cube_side_m / std::max(distance_m, config.depth_min_m);
}

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
  const double width_px = CubeWidth(view, config);
  std::optional<CubeBlob> largest;
  for (std::vector<cv::Point>& contour : contours) {
    const cv::Rect box = cv::boundingRect(contour);
    if (box.area() < config.cube_min_px2) continue;
    const double area = cv::countNonZero(FilledContour(contour, box));
    if (area < config.cube_min_px2 || area > config.cube_max_px2) continue;
    if (largest && area <= largest->area_px2) continue;
    const double cloth = ClothAround(contour, masks, view);
    const bool covered = cloth > kBesideCloth && area < kMostCovered * width_px * width_px;
    if (!IsCompact(contour, area) &&
        !(covered && Length(contour) < LongestOfCube(contour, view, config))) {
      continue;
    }
    largest = CubeBlob{std::move(contour), area, cloth > 0.5, covered};
  }
  return largest;
}

CubeSeen LocateCube(const CubeBlob& blob, const ColorMasks& masks, const View& view,
                    const PerceptionConfig& config) {
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
  cube.from_depth = top_depth_mm.has_value();
  if (top_depth_mm) {
    const Eigen::Vector3d top_W = view.camera.Deproject(cube.px, *top_depth_mm / 1000);
    top_m = top_W.z();
    cube.p_W = top_W - Eigen::Vector3d(0, 0, config.cube_side_m / 2);
  } else {
    cube.p_W = OntoLevel(view, cube.px, centre_m);
  }
  if (blob.covered) {
    if (const auto centre = CentreOfCovered(blob, masks, view, CubeWidth(view, config))) {
      cube.p_W = OntoLevel(view, *centre, top_m - config.cube_side_m / 2);
    }
  }
  cube.centre_px = view.camera.Project(cube.p_W);
  cube.in_roi = view.roi.contains(cv::Point(cvRound(cube.centre_px.x), cvRound(cube.centre_px.y)));
  std::vector<cv::Point> face_pixels;
  cv::findNonZero(face, face_pixels);
  for (cv::Point& pixel : face_pixels) pixel += box.tl();
  cube.yaw_rad = YawOf(face_pixels, view, top_m);
  return cube;
}

}  // namespace gusset
