#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/tri_mesh.h"

namespace gusset {

/// One rigid thing to draw. Colours everywhere here are what a pixel in full light shows: sRGB in
/// 0..1, which the shading scales (no gamma step).
struct RenderItem {
  const TriMesh* mesh =
      nullptr;  ///< Closed, or only ever seen from outside: back faces are culled.
  Eigen::Isometry3d X_WM = Eigen::Isometry3d::Identity();  ///< Pose of the mesh, metres.
  Eigen::Vector3f rgb = {0.5f, 0.5f, 0.5f};
  float mottle = 0;    ///< Strength 0..1 of a fabric-like texture fixed to the world's x and y.
  float contrast = 0;  ///< Of the light on it, if more than the light's own.
  /// Stays where it is from frame to frame. Only a hint: pictures are the same without, but slower.
  bool still = false;
};

/// A printed patch on one layer, seen from both sides. Cloth coordinates, metres.
struct LabelPatch {
  float u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  int layer = 0;
  bool operator==(const LabelPatch&) const = default;
};

/// A bag: layers of cloth that may share nodes (the seams). Nothing is drawn if x is empty.
struct ClothItem {
  std::vector<Eigen::Vector3f> x;             ///< Nodes, world frame, metres: the middle surface.
  std::vector<std::array<int, 3>> triangles;  ///< Wound the same way within a layer.
  std::vector<std::uint8_t> triangle_layer;   ///< One per triangle.
  /// Cloth coordinates of each node, metres: u across the opening, v from the rim (0) down.
  std::vector<Eigen::Vector2f> uv;
  float thickness_m = 0.001f;
  Eigen::Vector3f rgb = {0.89f, 0.87f, 0.82f};        ///< Cream cotton.
  Eigen::Vector3f label_rgb = {0.58f, 0.78f, 0.35f};  ///< Yellow-green; OpenCV hue 44.
  std::vector<LabelPatch> labels;
};

/// One soft key light and what the room sends back.
struct LightConfig {
  double azimuth_deg = 125;   ///< Where the key light comes from: from +x towards +y.
  double elevation_deg = 62;  ///< Above the table.
  double contrast = 0.45;     ///< 1 - (brightness of the darkest place / of the brightest).
  double shadow = 0.55;       ///< Strength of soft shadows and creases; 0: none.
  double uneven = 0.10;       ///< Brighter towards the light by this share per 0.3 m; tuned.
  double gain = 1;            ///< Scales every colour,
  double red = 1, blue = 1;   ///< red and blue against green.

  template <class V>
  void Fields(V& v) {
    v("azimuth_deg", azimuth_deg, {-180, 360});
    v("elevation_deg", elevation_deg, {20, 90});
    v("contrast", contrast, {0, 0.9});
    v("shadow", shadow, {0, 1});
    v("uneven", uneven, {0, 0.5});
    v("gain", gain, {0.2, 2});
    v("red", red, {0.5, 2});
    v("blue", blue, {0.5, 2});
  }
  bool operator==(const LightConfig&) const = default;
};

/// The canvas's folds as figure 5.2's states are compared with.
inline constexpr std::uint64_t kCanvasSeed = 1;

/// Everything one frame shows. Meshes need live only during Render.
struct SceneView {
  std::vector<RenderItem> items;
  ClothItem cloth;
  LightConfig light;
  std::uint64_t canvas_seed = kCanvasSeed;  ///< Of the mottling and its folds.
};

}  // namespace gusset
