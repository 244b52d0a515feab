#include "tools/gusset/photograph.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "perception/view.h"

namespace gusset {
namespace {

/// Larger or smaller factors are a mistake in the scale rather than a camera.
constexpr double kMostScaling = 32;
constexpr double kMostPixels = 1e8;
/// Fewer would show a label as a tenth of a pixel.
constexpr int kLeastSide_px = 32;

std::string Text(const cv::Rect& rect) {
  return std::to_string(rect.x) + "," + std::to_string(rect.y) + "," + std::to_string(rect.width) +
         "," + std::to_string(rect.height);
}

/// The window of an image whose top-left corner is at `corner`; black where the image ends.
cv::Mat Window(const cv::Mat& image, cv::Point corner, cv::Size size) {
  cv::Mat window = cv::Mat::zeros(size, image.type());
  const cv::Rect part = cv::Rect(corner, size) & cv::Rect({0, 0}, image.size());
  if (!part.empty()) image(part).copyTo(window(part - corner));
  return window;
}

/// Pixel centres are integers, so scaling by s takes c to s (c + 1/2) - 1/2.
cv::Point2d Scaled(cv::Point2d px, double s) {
  return {s * (px.x + 0.5) - 0.5, s * (px.y + 0.5) - 0.5};
}

/// Pixels per metre at the table, for a camera that looks straight down at it.
double PxPerMetre(const CameraModel& camera) {
  if (!(camera.X_WC.translation().z() > 0)) {
    throw InputError("the camera is not above the table");
  }
  const cv::Point2d origin = camera.Project(Eigen::Vector3d::Zero());
  const cv::Point2d beside = camera.Project({0.1, 0, 0});
  const double px_per_m = cv::norm(beside - origin) / 0.1;
  if (!std::isfinite(px_per_m) || px_per_m <= 0) {
    throw InputError("the camera does not look at the table's origin");
  }
  return px_per_m;
}

// The camera of an image that has been scaled to this size. @throws InputError if it was cut, too.
CameraModel FittedTo(const CameraModel& camera, cv::Size size) {
  CameraModel fitted = camera;
  Pinhole& k = fitted.pinhole;
  const double s = static_cast<double>(size.width) / k.width;
  if (std::abs(k.height * s - size.height) > 1) {
    throw InputError("is " + std::to_string(size.width) + "x" + std::to_string(size.height) +
                     " pixels, which is no scaled " + std::to_string(k.width) + "x" +
                     std::to_string(k.height) + " as --camera has it");
  }
  const cv::Point2d centre = Scaled({k.cx, k.cy}, s);
  k = {k.fx * s, k.fy * s, centre.x, centre.y, size.width, size.height};
  return fitted;
}

}  // namespace

double NominalPxPerMetre() { return Pinhole().fx / kNominalHeight_m; }

Photograph PreparePhotograph(const RgbdFrame& image, const PhotographOptions& options,
                             const PerceptionConfig& config) {
  const cv::Rect whole({0, 0}, image.color.size());
  const cv::Rect crop = options.crop.value_or(whole);
  if (std::min(whole.width, whole.height) < kLeastSide_px) {
    throw InputError("is " + std::to_string(whole.width) + "x" + std::to_string(whole.height) +
                     " pixels, of which nothing can be told; each side must have " +
                     std::to_string(kLeastSide_px));
  }
  if (std::min(crop.width, crop.height) < kLeastSide_px) {
    throw InputError("--crop: " + Text(crop) + " has a side below " +
                     std::to_string(kLeastSide_px) + " px");
  }
  if ((crop & whole) != crop) {
    throw InputError("--crop: " + Text(crop) + " is not within the image's " +
                     std::to_string(whole.width) + "x" + std::to_string(whole.height) + " pixels");
  }
  Photograph photograph;
  photograph.camera = OverheadCamera({}, kNominalHeight_m);
  photograph.frame.color = image.color(crop);
  if (!image.depth_mm.empty()) photograph.frame.depth_mm = image.depth_mm(crop);
  if (!options.px_per_m && !options.camera) {
    const cv::Size size = crop.size();
    const bool of_testbed = size == cv::Size(kFrameWidth, kFrameHeight) ||
                            size == cv::Size(config.roi_side, config.roi_side);
    photograph.warnings.push_back(
        of_testbed ? "taken for a frame of the testbed's camera: give --px-per-m or --camera if not"
                   : "scale guessed from the image's shape: give --px-per-m or --camera");
    return photograph;
  }

  CameraModel camera = photograph.camera;
  double scale = 0;
  cv::Point2d middle(0.5 * (crop.width - 1), 0.5 * (crop.height - 1));
  if (options.camera) {
    camera = FittedTo(*options.camera, whole.size());
    camera.pinhole.cx -= crop.x;
    camera.pinhole.cy -= crop.y;
    scale = NominalPxPerMetre() / PxPerMetre(camera);
    middle = camera.Project(Eigen::Vector3d::Zero());
  } else {
    scale = NominalPxPerMetre() / *options.px_per_m;
  }
  const cv::Size size(cvRound(crop.width * scale), cvRound(crop.height * scale));
  if (!(scale > 1 / kMostScaling && scale < kMostScaling) || size.empty() ||
      static_cast<double>(size.width) * size.height > kMostPixels) {
    throw InputError("--px-per-m or --camera: scaling the image by " + std::to_string(scale) +
                     " is not sensible");
  }
  cv::Mat color, depth;
  cv::resize(photograph.frame.color, color, size, 0, 0,
             scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  if (!image.depth_mm.empty()) {
    cv::resize(photograph.frame.depth_mm, depth, size, 0, 0, cv::INTER_NEAREST);
  }

  const cv::Point2d origin = Scaled(middle, scale);
  const cv::Point2d in_view = OverheadCamera({}, kNominalHeight_m).Project(Eigen::Vector3d::Zero());
  const cv::Point2d offset = origin - in_view;
  cv::Point corner(cvRound(offset.x), cvRound(offset.y));
  cv::Size window(kFrameWidth, kFrameHeight);
  const cv::Rect full(corner, window);
  // Half a pixel may be missing at each border of a frame that just fits.
  const cv::Rect there(-1, -1, size.width + 2, size.height + 2);
  if ((full & there) != full) {
    window = {config.roi_side, config.roi_side};
    corner += cv::Point(config.roi_x, config.roi_y);
  }
  photograph.frame.color = Window(color, corner, window);
  photograph.frame.depth_mm = depth.empty() ? depth : Window(depth, corner, window);
  if (options.camera) {
    const cv::Point2d principal =
        Scaled({camera.pinhole.cx, camera.pinhole.cy}, scale) - cv::Point2d(full.tl());
    photograph.camera.X_WC = camera.X_WC;
    photograph.camera.pinhole = {camera.pinhole.fx * scale,
                                 camera.pinhole.fy * scale,
                                 principal.x,
                                 principal.y,
                                 kFrameWidth,
                                 kFrameHeight};
  } else {
    photograph.camera.pinhole.cx += origin.x - in_view.x - full.x;
    photograph.camera.pinhole.cy += origin.y - in_view.y - full.y;
  }
  return photograph;
}

}  // namespace gusset
