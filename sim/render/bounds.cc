#include "sim/render/bounds.h"

namespace gusset {
namespace {

Eigen::Matrix<float, 4, 8> Clip(const Corners& box, const Eigen::Matrix4f& clip_from_world) {
  return clip_from_world * box.colwise().homogeneous();
}

}  // namespace

Bounds Bounds::Of(const std::vector<Eigen::Vector3f>& points) {
  Bounds bounds;
  if (points.empty()) return bounds;
  bounds.lo = bounds.hi = points[0];
  for (const Eigen::Vector3f& p : points) {
    bounds.lo = bounds.lo.cwiseMin(p);
    bounds.hi = bounds.hi.cwiseMax(p);
  }
  return bounds;
}

Corners Bounds::corners() const {
  Corners corners;
  for (int i = 0; i < 8; ++i) {
    corners.col(i) << (i & 1 ? hi : lo).x(), (i & 2 ? hi : lo).y(), (i & 4 ? hi : lo).z();
  }
  return corners;
}

bool MayBeSeen(const Corners& box, const Eigen::Matrix4f& clip_from_world) {
  const Eigen::Matrix<float, 4, 8> clip = Clip(box, clip_from_world);
  for (int axis = 0; axis < 3; ++axis) {
    if ((clip.row(axis).array() > clip.row(3).array()).all()) return false;
    if ((clip.row(axis).array() < -clip.row(3).array()).all()) return false;
  }
  return true;
}

cv::Rect PixelsOf(const Corners& box, const Eigen::Matrix4f& clip_from_world, cv::Size size) {
  if (!MayBeSeen(box, clip_from_world)) return {};
  const Eigen::Matrix<float, 4, 8> clip = Clip(box, clip_from_world);
  if (clip.row(3).minCoeff() < 1e-3f) return {{0, 0}, size};
  const Eigen::Array2f side(static_cast<float>(size.width), static_cast<float>(size.height));
  const Eigen::Array<float, 2, 8> px =
      ((clip.topRows<2>().array().rowwise() / clip.row(3).array()) * 0.5f + 0.5f).colwise() * side;
  // One pixel more on every side for what rounding does.
  const Eigen::Array2f least = (px.rowwise().minCoeff().floor() - 1).max(0).min(side);
  const Eigen::Array2f most = (px.rowwise().maxCoeff().ceil() + 1).max(0).min(side);
  return {cv::Point(static_cast<int>(least.x()), static_cast<int>(least.y())),
          cv::Point(static_cast<int>(most.x()), static_cast<int>(most.y()))};
}

}  // namespace gusset
