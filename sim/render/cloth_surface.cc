#include "sim/render/cloth_surface.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "base/error.h"

namespace gusset {
namespace {

void CheckCloth(const ClothItem& cloth) {
  const auto refuse = [](const std::string& what) { throw InputError("cloth to draw: " + what); };
  if (cloth.triangle_layer.size() != cloth.triangles.size()) {
    refuse("triangle_layer has " + std::to_string(cloth.triangle_layer.size()) + " entries for " +
           std::to_string(cloth.triangles.size()) + " triangles");
  }
  if (cloth.uv.size() != cloth.x.size()) {
    refuse("uv has " + std::to_string(cloth.uv.size()) + " entries for " +
           std::to_string(cloth.x.size()) + " nodes");
  }
  for (const auto& t : cloth.triangles) {
    for (const int node : t) {
      if (node < 0 || node >= static_cast<int>(cloth.x.size())) {
        refuse("a triangle names node " + std::to_string(node) + " of " +
               std::to_string(cloth.x.size()));
      }
    }
  }
}

}  // namespace

ClothSurface::ClothSurface(const ClothItem& cloth)
    : source_triangles_(cloth.triangles),
      source_layers_(cloth.triangle_layer),
      source_uv_(cloth.uv) {
  CheckCloth(cloth);
  std::map<std::pair<int, int>, unsigned> vertex_of;  // by layer and node
  for (std::size_t t = 0; t < cloth.triangles.size(); ++t) {
    const int layer = cloth.triangle_layer[t];
    std::array<unsigned, 3> triangle;
    for (int k = 0; k < 3; ++k) {
      const int node = cloth.triangles[t][k];
      const auto [entry, is_new] =
          vertex_of.try_emplace({layer, node}, static_cast<unsigned>(node_of_.size()));
      if (is_new) {
        node_of_.push_back(node);
        const Eigen::Vector2f& uv = cloth.uv[node];
        uv_layer_.emplace_back(uv.x(), uv.y(), static_cast<float>(layer));
      }
      triangle[k] = entry->second;
    }
    triangles_.push_back(triangle);
  }
}

bool ClothSurface::Fits(const ClothItem& cloth) const {
  return cloth.x.size() == cloth.uv.size() && cloth.triangles == source_triangles_ &&
         cloth.triangle_layer == source_layers_ && cloth.uv == source_uv_;
}

void ClothSurface::Update(const ClothItem& cloth) {
  for (const Eigen::Vector3f& x : cloth.x) {
    if (!x.allFinite()) throw InputError("cloth to draw: a node is not finite");
  }
  half_thickness_m_ = std::max(cloth.thickness_m / 2, 1e-6f);  // the sign tells the sides apart
  positions_.clear();
  for (const int node : node_of_) positions_.push_back(cloth.x[node]);

  normals_.assign(positions_.size(), Eigen::Vector3f::Zero());
  for (const auto& t : triangles_) {
    const Eigen::Vector3f& a = positions_[t[0]];
    const Eigen::Vector3f n = (positions_[t[1]] - a).cross(positions_[t[2]] - a);
    for (const unsigned corner : t) normals_[corner] += n;
  }
  for (Eigen::Vector3f& n : normals_) n.normalize();
}

}  // namespace gusset
