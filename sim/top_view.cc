#include "sim/top_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gusset {

std::vector<BagLabel> MakeLabels(const BagConfig& bag) {
  std::vector<BagLabel> labels;
  const double n = bag.labels_per_layer;
  for (int layer = 0; layer < 2; ++layer) {
    for (int k = 0; k < bag.labels_per_layer; ++k) {
      const double u = bag.opening_m * (k + 0.5) / n;
      BagLabel label;
      label.u0 = static_cast<float>(u - 0.5 * bag.label_width_m);
      label.u1 = static_cast<float>(u + 0.5 * bag.label_width_m);
      label.v0 = 0;
      label.v1 = static_cast<float>(bag.label_height_m);
      label.layer = layer;
      labels.push_back(label);
    }
  }
  return labels;
}

TopView LookAtBag(const ClothMesh& mesh, const Vec3Array& x, const std::vector<BagLabel>& labels,
                  const CameraModel& camera, const std::array<int, 4>& roi) {
  const int width = roi[2], height = roi[3];
  TopView view;
  view.mask.assign(static_cast<std::size_t>(width * height), 0);
  view.label_px.assign(labels.size(), 0);
  view.label_centre_px.assign(labels.size(), Eigen::Vector2d::Zero());
  std::vector<float> depth(view.mask.size(), std::numeric_limits<float>::max());
  std::vector<int> shown(view.mask.size(), -1);  // label index, or -1
  std::vector<Vec3f> pixel(x.size());            // column and row in the ROI, depth
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Eigen::Vector3d p = x[i].cast<double>();
    const cv::Point2d px = camera.Project(p);
    pixel[i] << static_cast<float>(px.x - roi[0]), static_cast<float>(px.y - roi[1]),
        static_cast<float>((camera.X_WC.inverse() * p).z());
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& n = mesh.triangles[t];
    const Vec3f &a = pixel[n[0]], &b = pixel[n[1]], &c = pixel[n[2]];
    const float twice = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (std::abs(twice) < 1e-9f) continue;
    const int c0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}))));
    const int c1 =
        std::min(width - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}))));
    const int r0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}))));
    const int r1 =
        std::min(height - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}))));
    for (int row = r0; row <= r1; ++row) {
      for (int col = c0; col <= c1; ++col) {
        const float px = static_cast<float>(col), py = static_cast<float>(row);
        const float w0 = ((b.x() - px) * (c.y() - py) - (b.y() - py) * (c.x() - px)) / twice;
        const float w1 = ((c.x() - px) * (a.y() - py) - (c.y() - py) * (a.x() - px)) / twice;
        const float w2 = 1 - w0 - w1;
        if (w0 < 0 || w1 < 0 || w2 < 0) continue;
        const std::size_t at = static_cast<std::size_t>(row * width + col);
        const float z = w0 * a.z() + w1 * b.z() + w2 * c.z();
        if (z >= depth[at]) continue;
        depth[at] = z;
        view.mask[at] = 1;
        const Eigen::Vector2f uv = w0 * mesh.uv[n[0]] + w1 * mesh.uv[n[1]] + w2 * mesh.uv[n[2]];
        shown[at] = -1;
        if (uv.y() > 0.1f) continue;  // labels sit at the rim
        for (std::size_t k = 0; k < labels.size(); ++k) {
          const BagLabel& label = labels[k];
          if (mesh.triangle_layer[t] == label.layer && uv.x() >= label.u0 && uv.x() <= label.u1 &&
              uv.y() >= label.v0 && uv.y() <= label.v1) {
            shown[at] = static_cast<int>(k);
          }
        }
      }
    }
  }
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const std::size_t at = static_cast<std::size_t>(row * width + col);
      view.bag_px += view.mask[at];
      if (shown[at] < 0) continue;
      ++view.label_px[shown[at]];
      view.label_centre_px[shown[at]] += Eigen::Vector2d(col, row);
    }
  }
  for (std::size_t k = 0; k < labels.size(); ++k) {
    if (view.label_px[k] > 0) view.label_centre_px[k] /= view.label_px[k];
  }
  return view;
}

double ClothTopAt(const ClothMesh& mesh, const Vec3Array& x, const Eigen::Vector2d& point) {
  double top = -std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = x[t[0]].cast<double>(), b = x[t[1]].cast<double>(),
                          c = x[t[2]].cast<double>();
    // Barycentric coordinates in the plan.
    const auto cross = [](const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
      return u.x() * v.y() - u.y() * v.x();
    };
    const Eigen::Vector2d pa = a.head<2>() - point, pb = b.head<2>() - point,
                          pc = c.head<2>() - point;
    const double area = cross(pb - pa, pc - pa);
    if (area == 0) continue;
    const double w0 = cross(pb, pc) / area, w1 = cross(pc, pa) / area;
    if (w0 < 0 || w1 < 0 || w0 + w1 > 1) continue;
    top = std::max(top, w0 * a.z() + w1 * b.z() + (1 - w0 - w1) * c.z());
  }
  return top;
}

}  // namespace gusset
