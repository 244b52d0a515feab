#pragma once

#include <cmath>

#include "sim/cloth/bag_mesh.h"
#include "sim/render/scene_view.h"

namespace gusset {

/// A bag laid flat round the origin, rim towards -y, five labels per layer.
inline ClothItem FlatBag() {
  const BagConfig config;
  const ClothMesh mesh = MakeBagMesh(config);
  ClothItem bag;
  bag.triangles = mesh.triangles;
  bag.triangle_layer = mesh.triangle_layer;
  bag.uv = mesh.uv;
  bag.thickness_m = mesh.thickness_m;
  for (const Eigen::Vector3f& p : mesh.rest) {
    bag.x.emplace_back(p.x() - 0.15f, p.y() - 0.175f,
                       p.z() + mesh.thickness_m);  // the lower layer on z = 0
  }
  for (int layer = 0; layer < 2; ++layer) {
    for (int i = 0; i < 5; ++i) {
      const float u = 0.06f * (static_cast<float>(i) + 0.5f);
      bag.labels.push_back({u - 0.006f, u + 0.006f, 0, 0.014f, layer});
    }
  }
  return bag;
}

/// The same drawn together into a heap of folds: about a quarter of the area.
inline ClothItem CrumpledBag() {
  const auto waves = [](float x, float y, float phase) {
    return std::sin(21 * x + 9 * y + phase) * std::sin(33 * y - 15 * x + 2 * phase) +
           0.5f * std::sin(69 * x + 51 * y + 3 * phase);
  };
  ClothItem bag = FlatBag();
  for (Eigen::Vector3f& p : bag.x) {
    const float x = p.x(), y = p.y(), z = p.z();
    p = {0.45f * x + 0.022f * waves(x, y, 0.7f), 0.42f * y + 0.022f * waves(x, y, 2.7f),
         0.02f + 0.010f * waves(x, y, 5.0f) + 4 * z};
  }
  return bag;
}

}  // namespace gusset
