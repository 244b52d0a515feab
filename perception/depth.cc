#include "perception/depth.h"

#include <algorithm>

#include "perception/require.h"

namespace gusset {

std::optional<double> MedianDepth(std::vector<std::uint16_t> depths_mm,
                                  const PerceptionConfig& config) {
  std::erase_if(depths_mm, [&](std::uint16_t mm) {
    return mm == 0 || mm < config.depth_min_m * 1000 || mm > config.depth_max_m * 1000;
  });
  if (depths_mm.empty()) return std::nullopt;
  const auto middle = depths_mm.begin() + (depths_mm.size() - 1) / 2;
  std::nth_element(depths_mm.begin(), middle, depths_mm.end());
  return *middle;
}

std::optional<double> DepthAt(const View& view, cv::Point2d px, const PerceptionConfig& config) {
  const cv::Mat& depth = view.frame.depth_mm;
  if (depth.empty()) return std::nullopt;
  RequirePixel(px, "px");
  const int half = config.depth_window_px / 2;
  const cv::Rect window =
      cv::Rect(cvRound(px.x) - half, cvRound(px.y) - half, 2 * half + 1, 2 * half + 1) &
      cv::Rect({0, 0}, depth.size());
  std::vector<std::uint16_t> values;
  for (int y = window.y; y < window.br().y; ++y) {
    const auto* row = depth.ptr<std::uint16_t>(y);
    values.insert(values.end(), row + window.x, row + window.br().x);
  }
  const std::optional<double> median_mm = MedianDepth(std::move(values), config);
  if (!median_mm) return std::nullopt;
  return *median_mm / 1000;
}

PosePoint Deproject(const View& view, cv::Point2d px, const PerceptionConfig& config) {
  if (const std::optional<double> depth_m = DepthAt(view, px, config)) {
    return {px, view.camera.Deproject(px, *depth_m), true};
  }
  return {px, OntoLevel(view, px, config.table_height_m), false};
}

Eigen::Vector3d OntoLevel(const View& view, cv::Point2d px, double height_m) {
  const Eigen::Vector3d p_W = view.camera.OntoPlane(px, height_m);
  return p_W.allFinite() ? p_W : Eigen::Vector3d(0, 0, height_m);
}

}  // namespace gusset
