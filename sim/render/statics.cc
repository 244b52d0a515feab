#include "sim/render/statics.h"

#include "sim/pedestal.h"

namespace gusset {

TriMesh BoxMesh(const Eigen::Vector3d& size_m) {
  const Eigen::Vector3f half = (size_m / 2).cast<float>();
  TriMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? half.x() : -half.x(), i & 2 ? half.y() : -half.y(),
                               i & 4 ? half.z() : -half.z());
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

Statics::Statics() {
  struct Block {
    Eigen::Vector3d size, centre;
    Eigen::Vector3f rgb;
    float mottle;
  };
  // The canvas is what lies on z = 0; it stands proud of the table by 1 mm so as to hide it.
  const Block blocks[] = {
      {{0.68, 0.68, 0.020}, {0, 0, -0.010}, {0.085f, 0.115f, 0.120f}, 0.30f},
      {{2.00, 1.80, 0.049}, {0, 0, -0.0255}, {0.86f, 0.87f, 0.88f}, 0.02f},
      {{8.00, 8.00, 0.040}, {0, 0, -0.77}, {0.42f, 0.43f, 0.45f}, 0.0f},
      {Pedestal().size_m, Pedestal().centre_m, {0.33f, 0.34f, 0.36f}, 0.0f},
  };
  meshes_.reserve(std::size(blocks));  // items point into it
  for (const Block& block : blocks) {
    meshes_.push_back(BoxMesh(block.size));
    RenderItem item;
    item.mesh = &meshes_.back();
    item.X_WM.translation() = block.centre;
    item.rgb = block.rgb;
    item.mottle = block.mottle;
    item.still = true;
    items_.push_back(item);
  }
}

}  // namespace gusset
