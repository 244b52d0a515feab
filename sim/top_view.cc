#include "sim/top_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace gusset {

std::vector<LabelPatch> MakeLabels(const BagConfig& bag) {
  std::vector<LabelPatch> labels;
  const double n = bag.labels_per_layer;
  for (int layer = 0; layer < 2; ++layer) {
    for (int k = 0; k < bag.labels_per_layer; ++k) {
      const double u = bag.opening_m * (k + 0.5) / n;
      LabelPatch label;
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

namespace {

/// A region of an image with the depth of what has been drawn into it so far.
class Canvas {
 public:
  Canvas(const CameraModel& camera, const std::array<int, 4>& roi)
      : camera_(camera),
        X_CW_(camera.X_WC.inverse()),
        roi_(roi),
        depth_(static_cast<std::size_t>(roi[2] * roi[3]), std::numeric_limits<float>::max()) {}

  /// Column and row in the region, distance along the optical axis.
  Vec3f Project(const Eigen::Vector3d& p_W) const {
    const cv::Point2d px = camera_.Project(p_W);
    return {static_cast<float>(px.x - roi_[0]), static_cast<float>(px.y - roi_[1]),
            static_cast<float>((X_CW_ * p_W).z())};
  }

  /// Calls paint(pixel index, {w0, w1, w2}) for every pixel at which the triangle is nearer than
  /// all drawn before; w are the weights of its corners.
  template <class Paint>
  void Draw(const Vec3f& a, const Vec3f& b, const Vec3f& c, Paint paint) {
    const float twice = TwiceArea(a, b, c);
    if (std::abs(twice) < 1e-9f) return;
    const int c0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}))));
    const int c1 =
        std::min(roi_[2] - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}))));
    const int r0 = std::max(0, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}))));
    const int r1 =
        std::min(roi_[3] - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}))));
    for (int row = r0; row <= r1; ++row) {
      for (int col = c0; col <= c1; ++col) {
        const float px = static_cast<float>(col), py = static_cast<float>(row);
        const float w0 = ((b.x() - px) * (c.y() - py) - (b.y() - py) * (c.x() - px)) / twice;
        const float w1 = ((c.x() - px) * (a.y() - py) - (c.y() - py) * (a.x() - px)) / twice;
        const float w2 = 1 - w0 - w1;
        if (w0 < 0 || w1 < 0 || w2 < 0) continue;
        const std::size_t at = static_cast<std::size_t>(row * roi_[2] + col);
        const float z = w0 * a.z() + w1 * b.z() + w2 * c.z();
        if (z >= depth_[at]) continue;
        depth_[at] = z;
        paint(at, std::array<float, 3>{w0, w1, w2});
      }
    }
  }

  /// Below 0 where one sees the corners counter-clockwise: the image's y points down.
  static float TwiceArea(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
  }

 private:
  const CameraModel& camera_;
  Eigen::Isometry3d X_CW_;
  std::array<int, 4> roi_;
  std::vector<float> depth_;
};

std::int16_t LabelAt(const std::vector<LabelPatch>& labels, int layer, const Eigen::Vector2f& uv) {
  if (uv.y() > 0.1f) return -1;  // labels sit at the rim
  std::int16_t found = -1;
  for (std::size_t k = 0; k < labels.size(); ++k) {
    const LabelPatch& label = labels[k];
    if (layer == label.layer && uv.x() >= label.u0 && uv.x() <= label.u1 && uv.y() >= label.v0 &&
        uv.y() <= label.v1) {
      found = static_cast<std::int16_t>(k);
    }
  }
  return found;
}

// Triangles are wound so that the normals of a bag laid flat point up, out of layer 1, into layer
// 0.
Shown SideOf(int layer, bool counter_clockwise) {
  if (layer == 1) return counter_clockwise ? Shown::kOuter1 : Shown::kInner1;
  return counter_clockwise ? Shown::kInner0 : Shown::kOuter0;
}

// Paints cloth and cube into one view.
class Painter {
 public:
  Painter(const std::vector<LabelPatch>& labels, const CameraModel& camera,
          const std::array<int, 4>& roi)
      : canvas_(camera, roi), labels_(labels), width_(roi[2]), height_(roi[3]) {
    const auto count = static_cast<std::size_t>(width_ * height_);
    view_.mask.assign(count, 0);
    view_.shown.assign(count, Shown::kNothing);
    view_.rim_m.assign(count, 0);
    view_.label.assign(count, -1);
    view_.label_px.assign(labels.size(), 0);
    view_.label_centre_px.assign(labels.size(), Eigen::Vector2d::Zero());
  }

  /// A triangle of cloth: its corners as projected, and in cloth.
  void Cloth(const std::array<Vec3f, 3>& p, const std::array<Eigen::Vector2f, 3>& uv, int layer,
             Shown side) {
    canvas_.Draw(p[0], p[1], p[2], [&](std::size_t at, const std::array<float, 3>& w) {
      const Eigen::Vector2f here = w[0] * uv[0] + w[1] * uv[1] + w[2] * uv[2];
      view_.mask[at] = 1;
      view_.shown[at] = side;
      view_.rim_m[at] = here.y();
      view_.label[at] = LabelAt(labels_, layer, here);
    });
  }

  /// After all cloth: the mask is of the cloth under it, too.
  void Cube(const TriMesh& cube_W) {
    for (const auto& n : cube_W.triangles) {
      const auto corner = [&](int k) {
        return canvas_.Project(cube_W.vertices[static_cast<std::size_t>(n[k])].cast<double>());
      };
      canvas_.Draw(corner(0), corner(1), corner(2), [&](std::size_t at, const auto&) {
        view_.shown[at] = Shown::kCube;
        view_.label[at] = -1;
      });
    }
  }

  /// The view with its sums. Call once, at the end.
  TopView Finish() {
    for (int row = 0; row < height_; ++row) {
      for (int col = 0; col < width_; ++col) {
        const std::size_t at = static_cast<std::size_t>(row * width_ + col);
        view_.bag_px += view_.mask[at];
        view_.cube_px += view_.shown[at] == Shown::kCube;
        if (view_.label[at] < 0) continue;
        ++view_.label_px[view_.label[at]];
        view_.label_centre_px[view_.label[at]] += Eigen::Vector2d(col, row);
      }
    }
    for (std::size_t k = 0; k < labels_.size(); ++k) {
      if (view_.label_px[k] > 0) view_.label_centre_px[k] /= view_.label_px[k];
    }
    return std::move(view_);
  }

  const Canvas& canvas() const { return canvas_; }

 private:
  Canvas canvas_;
  const std::vector<LabelPatch>& labels_;
  int width_, height_;
  TopView view_;
};

}  // namespace

TopView LookAtBag(const ClothSurface& cloth_W, const std::vector<LabelPatch>& labels,
                  const CameraModel& camera, const std::array<int, 4>& roi, const TriMesh* cube_W) {
  Painter painter(labels, camera, roi);
  std::vector<Vec3f> pixel(cloth_W.positions().size());
  for (const bool along_normals : {true, false}) {
    const float offset = along_normals ? cloth_W.half_thickness_m() : -cloth_W.half_thickness_m();
    for (std::size_t i = 0; i < pixel.size(); ++i) {
      const Vec3f p = cloth_W.positions()[i] + offset * cloth_W.normals()[i];
      pixel[i] = painter.canvas().Project(p.cast<double>());
    }
    for (const auto& n : cloth_W.triangles()) {
      const std::array<Vec3f, 3> p = {pixel[n[0]], pixel[n[1]], pixel[n[2]]};
      // Each side of the shell is seen from its own side only.
      const bool counter_clockwise = Canvas::TwiceArea(p[0], p[1], p[2]) < 0;
      if (counter_clockwise != along_normals) continue;
      const auto& uv = cloth_W.uv_layer();
      const int layer = static_cast<int>(uv[n[0]].z());
      painter.Cloth(p, {uv[n[0]].head<2>(), uv[n[1]].head<2>(), uv[n[2]].head<2>()}, layer,
                    SideOf(layer, counter_clockwise));
    }
  }
  if (cube_W != nullptr) painter.Cube(*cube_W);
  return painter.Finish();
}

TopView LookAtBag(const ClothMesh& mesh, const Vec3Array& x, const std::vector<LabelPatch>& labels,
                  const CameraModel& camera, const std::array<int, 4>& roi, const TriMesh* cube_W) {
  Painter painter(labels, camera, roi);
  std::vector<Vec3f> pixel(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    pixel[i] = painter.canvas().Project(x[i].cast<double>());
  }
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& n = mesh.triangles[t];
    const std::array<Vec3f, 3> p = {pixel[n[0]], pixel[n[1]], pixel[n[2]]};
    const int layer = mesh.triangle_layer[t];
    painter.Cloth(p, {mesh.uv[n[0]], mesh.uv[n[1]], mesh.uv[n[2]]}, layer,
                  SideOf(layer, Canvas::TwiceArea(p[0], p[1], p[2]) < 0));
  }
  if (cube_W != nullptr) painter.Cube(*cube_W);
  return painter.Finish();
}

}  // namespace gusset
