#include "sim/render/mesh_normals.h"

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>

namespace gusset {
namespace {

using Key3 = std::tuple<float, float, float>;
Key3 KeyOf(const Eigen::Vector3f& p) { return {p.x(), p.y(), p.z()}; }

}  // namespace

ShadedMesh WithNormals(const TriMesh& mesh, double crease_deg) {
  const float cos_crease = static_cast<float>(std::cos(crease_deg * std::numbers::pi / 180));

  std::vector<Eigen::Vector3f> area_normals;  // length is twice the face's area
  std::vector<std::array<int, 3>> faces;
  std::map<Key3, std::vector<int>> faces_at;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const Eigen::Vector3f& a = mesh.vertices[t[0]];
    const Eigen::Vector3f n = (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a);
    if (!(n.norm() > 0)) continue;
    for (const int corner : t) {
      faces_at[KeyOf(mesh.vertices[corner])].push_back(static_cast<int>(faces.size()));
    }
    faces.push_back(t);
    area_normals.push_back(n);
  }

  ShadedMesh out;
  std::map<std::pair<Key3, Key3>, unsigned> index_of;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Eigen::Vector3f own = area_normals[f].normalized();
    std::array<unsigned, 3> triangle;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3f& position = mesh.vertices[faces[f][k]];
      Eigen::Vector3f sum = Eigen::Vector3f::Zero();
      for (const int g : faces_at[KeyOf(position)]) {
        if (area_normals[g].normalized().dot(own) >= cos_crease) sum += area_normals[g];
      }
      const Eigen::Vector3f normal = sum.normalized();
      const auto [entry, is_new] = index_of.try_emplace({KeyOf(position), KeyOf(normal)},
                                                        static_cast<unsigned>(out.vertices.size()));
      if (is_new) out.vertices.push_back({position, normal});
      triangle[k] = entry->second;
    }
    out.triangles.push_back(triangle);
  }
  return out;
}

}  // namespace gusset
