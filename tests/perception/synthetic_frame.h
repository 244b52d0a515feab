#pragma once

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "base/random.h"
#include "perception/camera_model.h"
#include "perception/rgbd_frame.h"

namespace gusset::synthetic {

/// Colours (BGR) as the camera of figure 5.2 saw them.
inline const cv::Scalar kCanvas(30, 30, 22);
inline const cv::Scalar kTable(235, 235, 235);
inline const cv::Scalar kCloth(196, 206, 209);
inline const cv::Scalar kLabel(74, 196, 149);
inline const cv::Scalar kCube(22, 60, 225);

inline CameraModel Camera() { return OverheadCamera({}, 1.066); }

/// Pixels per metre on the table: 615 / 1.066.
inline constexpr double kPxPerMetre = 615 / 1.066;

/// Where a bag lies: centre (px of the frame) and turn (counter-clockwise as one sees the image; at
/// 0 the rim is at the top).
struct Pose {
  cv::Point2d centre{320, 240};
  double yaw_rad = 0;

  /// From the bag's own pixels: x to the right along the rim, y from the rim (negative) down.
  cv::Point2d operator()(double x, double y) const {
    const double c = std::cos(yaw_rad);
    const double s = std::sin(yaw_rad);
    return centre + cv::Point2d(c * x + s * y, -s * x + c * y);
  }
};

/// Paints the pixels whose centres lie in a convex polygon, so that areas are those of the polygon.
/// Its corners go counter-clockwise as one sees the image.
inline void Fill(cv::Mat& image, const std::vector<cv::Point2d>& polygon, const cv::Scalar& color) {
  std::vector<cv::Point> rounded(polygon.begin(), polygon.end());
  const cv::Rect box = (cv::boundingRect(rounded) + cv::Point(-2, -2) + cv::Size(4, 4)) &
                       cv::Rect({0, 0}, image.size());
  cv::Mat mask = cv::Mat::zeros(image.size(), CV_8UC1);
  mask(box) = 255;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const cv::Point2d from = polygon[k];
    const cv::Point2d side = polygon[(k + 1) % polygon.size()] - from;
    for (int y = box.y; y < box.br().y; ++y) {
      for (int x = box.x; x < box.br().x; ++x) {
        if (side.cross(cv::Point2d(x, y) - from) > 0) mask.at<uchar>(y, x) = 0;
      }
    }
  }
  image.setTo(color, mask);
}

inline void FillBox(cv::Mat& image, const Pose& pose, cv::Rect2d box, const cv::Scalar& color) {
  Fill(image,
       {pose(box.br().x, box.y), pose(box.x, box.y), pose(box.x, box.br().y),
        pose(box.br().x, box.br().y)},
       color);
}

/// Canvas with the white table around it, no bag, no cube; depth 1066 mm everywhere.
inline RgbdFrame EmptyTable() {
  RgbdFrame frame{cv::Mat(480, 640, CV_8UC3, kTable),
                  cv::Mat(480, 640, CV_16UC1, cv::Scalar(1066))};
  const int half = cvRound(0.34 * kPxPerMetre);
  frame.color(cv::Rect(320 - half, 240 - half, 2 * half, 2 * half) & cv::Rect(0, 0, 640, 480)) =
      kCanvas;
  return frame;
}

/// Bag 1 laid flat (0.30 m of rim, 0.35 m deep), with five labels along the rim.
inline constexpr double kHalfWidth = 0.15 * kPxPerMetre;
inline constexpr double kHalfDepth = 0.175 * kPxPerMetre;

inline void DrawLabel(RgbdFrame& frame, const Pose& pose, cv::Point2d at) {
  FillBox(frame.color, pose, {at.x - 3, at.y - 3, 6, 6}, kLabel);
}

inline void DrawFlatBag(RgbdFrame& frame, const Pose& pose = {}, int labels = 5) {
  FillBox(frame.color, pose, {-kHalfWidth, -kHalfDepth, 2 * kHalfWidth, 2 * kHalfDepth}, kCloth);
  for (int k = 0; k < labels; ++k) {
    const double x = ((k + 0.5) / labels * 2 - 1) * kHalfWidth;
    DrawLabel(frame, pose, {x, -kHalfDepth + 5});
  }
}

/// The labels' places on a bag whose upper layer has been drawn back: lower row at the rim, upper
/// row in an arch behind it.
inline std::vector<cv::Point2d> MouthLabels() {
  return {{-64, -95}, {-32, -96}, {0, -96}, {32, -96}, {64, -95},
          {-58, -75}, {-36, -50}, {0, -38}, {36, -50}, {58, -75}};
}

inline void DrawOpenBag(RgbdFrame& frame, const Pose& pose = {}) {
  DrawFlatBag(frame, pose, 0);
  for (const cv::Point2d& at : MouthLabels()) DrawLabel(frame, pose, at);
}

/// A bag one corner of which is folded over with both layers: all labels lie along the fold's
/// edges.
inline void DrawBagWithFoldedCorner(RgbdFrame& frame, const Pose& pose = {}) {
  DrawFlatBag(frame, pose, 0);
  for (const double x : {-64, -32, 0, 32}) DrawLabel(frame, pose, {x, -90});
  for (const double y : {-58, -26, 6, 38}) DrawLabel(frame, pose, {32, y});
}

/// A small heap of about 10,000 px^2 without labels, as in figure 5.2 a.
inline void DrawFoldedBag(RgbdFrame& frame, const Pose& pose = {}) {
  Fill(frame.color,
       {pose(40, -50), pose(-40, -54), pose(-56, 0), pose(-48, 46), pose(-6, 56), pose(48, 44),
        pose(52, -20)},
       kCloth);
}

/// The cube's top face at depth 1066 - 35 mm, 20.9 px wide.
inline void DrawCube(RgbdFrame& frame, cv::Point2d at, double yaw_rad = 0) {
  const double half = 0.5 * 0.035 * 615 / 1.031;
  FillBox(frame.color, {at, yaw_rad}, {-half, -half, 2 * half, 2 * half}, kCube);
  FillBox(frame.depth_mm, {at, yaw_rad}, {-half, -half, 2 * half, 2 * half}, cv::Scalar(1031));
}

/// Multiplies all colours, as a brighter or weaker lamp would, and adds sensor noise.
inline void Light(RgbdFrame& frame, double gain, double noise, std::uint64_t seed) {
  Rng rng(seed);
  for (int y = 0; y < frame.color.rows; ++y) {
    for (int x = 0; x < frame.color.cols; ++x) {
      for (uchar& value : frame.color.at<cv::Vec3b>(y, x).val) {
        value = cv::saturate_cast<uchar>(gain * value + noise * rng.Normal());
      }
    }
  }
}

/// The region of interest alone.
inline RgbdFrame Crop(const RgbdFrame& frame, const cv::Rect& part = {150, 70, 340, 340}) {
  return {frame.color(part).clone(), frame.depth_mm(part).clone()};
}

}  // namespace gusset::synthetic
