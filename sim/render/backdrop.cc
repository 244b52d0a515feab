#include "sim/render/backdrop.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace gusset {
namespace {

constexpr int kLooks = 3;

bool Same(const CameraModel& a, const CameraModel& b) {
  const Pinhole &p = a.pinhole, &q = b.pinhole;
  return p.fx == q.fx && p.fy == q.fy && p.cx == q.cx && p.cy == q.cy && p.width == q.width &&
         p.height == q.height && a.X_WC.matrix() == b.X_WC.matrix();
}

bool Same(const RenderItem& a, const RenderItem& b) {
  return a.mesh->vertices == b.mesh->vertices && a.mesh->triangles == b.mesh->triangles &&
         a.X_WM.matrix() == b.X_WM.matrix() && a.rgb == b.rgb && a.mottle == b.mottle &&
         a.contrast == b.contrast;
}

/// Joins what overlaps until nothing does.
void Join(std::vector<cv::Rect>& parts) {
  std::erase_if(parts, [](const cv::Rect& part) { return part.empty(); });
  for (std::size_t i = 0; i < parts.size();) {
    bool grew = false;
    for (std::size_t j = i + 1; j < parts.size() && !grew; ++j) {
      if ((parts[i] & parts[j]).empty()) continue;
      parts[i] |= parts[j];
      parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(j));
      grew = true;
    }
    i = grew ? 0 : i + 1;
  }
}

}  // namespace

bool Backdrop::IsOf(const SceneView& still, const CameraModel& camera) const {
  return Same(camera, camera_) && still.light == still_.light &&
         still.canvas_seed == still_.canvas_seed &&
         std::ranges::equal(still.items, still_.items,
                            [](const auto& a, const auto& b) { return Same(a, b); });
}

bool Backdrop::NoteLook(const SceneView& still, const CameraModel& camera) {
  if (looks_ > 0 && IsOf(still, camera)) {
    looks_ = std::min(looks_ + 1, kLooks);
    return looks_ == kLooks;
  }
  looks_ = 1;
  frame_.reset();
  still_ = still;
  camera_ = camera;
  meshes_.clear();
  meshes_.reserve(still.items.size());  // items point into it
  for (RenderItem& item : still_.items) {
    meshes_.push_back(*item.mesh);
    item.mesh = &meshes_.back();
  }
  return false;
}

void Backdrop::Keep(RgbdFrame frame) {
  lowest_m_ = std::numeric_limits<float>::max();
  for (int row = 0; row < frame.depth_mm.rows; ++row) {
    for (int column = 0; column < frame.depth_mm.cols; ++column) {
      const int depth_mm = frame.depth_mm.at<std::uint16_t>(row, column);
      if (depth_mm == 0) continue;
      // Depth is rounded to a millimetre, and the ray may point up.
      for (const int mm : {depth_mm - 1, depth_mm + 1}) {
        const double z = camera_.Deproject(cv::Point2d(column, row), 0.001 * mm).z();
        lowest_m_ = std::min(lowest_m_, static_cast<float>(z));
      }
    }
  }
  frame_ = std::move(frame);
}

std::vector<cv::Rect> Backdrop::ChangedParts(const std::vector<Corners>& moving,
                                             const std::vector<Corners>& still,
                                             const Eigen::Matrix4f& clip_from_world,
                                             const Eigen::Vector2f& shear, float blur_m,
                                             float map_half_m) const {
  constexpr float kFar_m = 100;
  const cv::Size size = frame_->color.size();
  std::vector<cv::Rect> parts;
  for (const Corners& box : moving) {
    parts.push_back(PixelsOf(box, clip_from_world, size));
    // Its shadow on the ground map,
    const Eigen::Matrix<float, 2, 8> at = box.topRows<2>() - shear * box.row(2);
    Eigen::Array2f lo = at.rowwise().minCoeff().array() - blur_m;
    Eigen::Array2f hi = at.rowwise().maxCoeff().array() + blur_m;
    if ((lo > map_half_m).any() || (hi < -map_half_m).any()) continue;
    lo = (lo < -map_half_m).select(-kFar_m, lo);
    hi = (hi > map_half_m).select(kFar_m, hi);
    // and on what stands still and can be seen.
    for (const Corners& on : still) {
      const Eigen::Array3f on_lo = on.rowwise().minCoeff(), on_hi = on.rowwise().maxCoeff();
      const float z0 = std::max(on_lo.z(), lowest_m_), z1 = on_hi.z();
      if (z1 < lowest_m_) continue;
      const Eigen::Array2f at_z0 = z0 * shear, at_z1 = z1 * shear;
      Bounds shadow;
      shadow.lo << (lo + at_z0.min(at_z1)).max(on_lo.head<2>()), z0;
      shadow.hi << (hi + at_z0.max(at_z1)).min(on_hi.head<2>()), z1;
      if ((shadow.lo.array() > shadow.hi.array()).any()) continue;
      parts.push_back(PixelsOf(shadow.corners(), clip_from_world, size));
    }
  }
  Join(parts);
  return parts;
}

}  // namespace gusset
