#include "perception/view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>

#include "base/error.h"
#include "perception/require.h"

namespace gusset {
namespace {

bool IsFullView(cv::Size size) {
  return std::abs(size.width * 3 - size.height * 4) * 100 <= size.height * 4;
}

/// The part of an image that a view shows, and the size it is shown in.
struct Crop {
  cv::Rect part;
  cv::Size size;
};

Crop ViewCrop(cv::Size size, int roi_side) {
  if (IsFullView(size)) return {{{0, 0}, size}, {kFrameWidth, kFrameHeight}};
  const int side = std::min(size.width, size.height);
  return {{(size.width - side) / 2, (size.height - side) / 2, side, side}, {roi_side, roi_side}};
}

cv::Mat Apply(const Crop& crop, const cv::Mat& image, int interpolation) {
  const cv::Mat part = image(crop.part);
  if (part.size() == crop.size) return part;
  cv::Mat scaled;
  cv::resize(part, scaled, crop.size, 0, 0, interpolation);
  return scaled;
}

/// Area averaging when shrinking, so that thin labels do not fall between samples.
int ColorInterpolation(const Crop& crop) {
  return crop.part.width > crop.size.width ? cv::INTER_AREA : cv::INTER_LINEAR;
}

void CheckFrame(const RgbdFrame& frame) {
  if (frame.color.empty()) throw InputError("frame.color is empty");
  if (frame.color.type() != CV_8UC3) {
    throw InputError("frame.color has type " + cv::typeToString(frame.color.type()) +
                     ", must be CV_8UC3 (BGR)");
  }
  if (frame.depth_mm.empty()) return;
  if (frame.depth_mm.type() != CV_16UC1) {
    throw InputError("frame.depth_mm has type " + cv::typeToString(frame.depth_mm.type()) +
                     ", must be CV_16UC1 (mm)");
  }
  if (frame.depth_mm.size() != frame.color.size()) {
    throw InputError("frame.depth_mm is " + std::to_string(frame.depth_mm.cols) + "x" +
                     std::to_string(frame.depth_mm.rows) + ", but frame.color is " +
                     std::to_string(frame.color.cols) + "x" + std::to_string(frame.color.rows));
  }
}

void CheckCamera(const CameraModel& camera) {
  const Pinhole& pinhole = camera.pinhole;
  const bool numbers_ok = std::isfinite(pinhole.fx) && std::isfinite(pinhole.fy) &&
                          std::isfinite(pinhole.cx) && std::isfinite(pinhole.cy) &&
                          camera.X_WC.matrix().allFinite();
  if (!numbers_ok || pinhole.fx <= 0 || pinhole.fy <= 0 || pinhole.width <= 0 ||
      pinhole.height <= 0) {
    throw InputError("camera: fx, fy, width and height must be above 0, all numbers finite");
  }
  if (std::max(pinhole.fx, pinhole.fy) > kFarthest_px) {
    throw InputError("camera: fx and fy must be at most a million pixels");
  }
}

/// Pixel centres are integers, so scaling by s takes c to s (c + 1/2) - 1/2.
Pinhole Scaled(const Pinhole& pinhole, cv::Size size) {
  const double sx = static_cast<double>(size.width) / pinhole.width;
  const double sy = static_cast<double>(size.height) / pinhole.height;
  return {pinhole.fx * sx,
          pinhole.fy * sy,
          sx * (pinhole.cx + 0.5) - 0.5,
          sy * (pinhole.cy + 0.5) - 0.5,
          size.width,
          size.height};
}

}  // namespace

cv::Mat ScaleToView(const cv::Mat& color, int roi_side) {
  if (color.empty()) throw InputError("color is empty");
  if (roi_side < 1) throw InputError("roi_side = " + std::to_string(roi_side) + " is not above 0");
  const Crop crop = ViewCrop(color.size(), roi_side);
  return Apply(crop, color, ColorInterpolation(crop));
}

View MakeView(const RgbdFrame& frame, const CameraModel& camera, const PerceptionConfig& config) {
  CheckFrame(frame);
  CheckCamera(camera);
  const cv::Rect roi(config.roi_x, config.roi_y, config.roi_side, config.roi_side);
  if ((roi & cv::Rect(0, 0, kFrameWidth, kFrameHeight)) != roi) {
    throw InputError("perception: the region of interest at (" + std::to_string(roi.x) + ", " +
                     std::to_string(roi.y) + ") with side " + std::to_string(roi.width) +
                     " is not within 640x480");
  }

  const Crop crop = ViewCrop(frame.color.size(), config.roi_side);
  View view;
  view.has_surroundings = IsFullView(frame.color.size());
  view.scaled = crop.part.size() != crop.size;
  view.frame.color = Apply(crop, frame.color, ColorInterpolation(crop));
  if (!frame.depth_mm.empty()) {
    // Depths of two surfaces must not be averaged.
    view.frame.depth_mm = Apply(crop, frame.depth_mm, cv::INTER_NEAREST);
  }
  view.camera.X_WC = camera.X_WC;
  view.camera.pinhole = Scaled(camera.pinhole, {kFrameWidth, kFrameHeight});
  view.roi = roi;
  if (!view.has_surroundings) {
    view.camera.pinhole.cx -= roi.x;
    view.camera.pinhole.cy -= roi.y;
    view.camera.pinhole.width = view.camera.pinhole.height = roi.width;
    view.roi -= roi.tl();
  }
  return view;
}

}  // namespace gusset
