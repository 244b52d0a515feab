#include "sim/render/cloth_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "base/error.h"

namespace gusset {
namespace {

using Triangles = std::vector<std::array<unsigned, 3>>;
using Weights = std::map<int, float>;  // sums to 1

/// Who is whose neighbour in one level's mesh.
class Neighbourhood {
 public:
  Neighbourhood(const Triangles& triangles, int vertices)
      : border_(vertices), ring_start_(vertices) {
    for (const auto& t : triangles) {
      for (int k = 0; k < 3; ++k) {
        const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
        opposite_[{a, b}] = c;
        ring_start_[a] = b;
      }
    }
    for (const auto& [edge, c] : opposite_) {
      if (opposite_.contains({edge.second, edge.first})) continue;
      border_[edge.first].push_back(edge.second);
      border_[edge.second].push_back(edge.first);
    }
  }
  /// Third corner of the triangle left of a -> b.
  std::optional<int> Opposite(int a, int b) const {
    const auto found = opposite_.find({a, b});
    if (found == opposite_.end()) return std::nullopt;
    return found->second;
  }
  bool OnBorder(int v) const { return !border_[v].empty(); }
  /// The border's next vertex after b, coming from a.
  std::optional<int> Along(int a, int b) const {
    const std::vector<int>& next = border_[b];
    if (next.size() != 2) return std::nullopt;
    return next[0] == a ? next[1] : next[0];
  }
  /// Neighbours of an inner vertex in order, starting with `first`.
  std::vector<int> Ring(int v, int first) const {
    std::vector<int> ring{first};
    for (int next = opposite_.at({v, first}); next != first; next = opposite_.at({v, next})) {
      ring.push_back(next);
    }
    return ring;
  }
  int Valence(int v) const { return static_cast<int>(Ring(v, ring_start_[v]).size()); }
  const std::map<std::pair<int, int>, int>& edges() const { return opposite_; }

 private:
  std::map<std::pair<int, int>, int> opposite_;
  std::vector<std::vector<int>> border_;
  std::vector<int> ring_start_;
};

constexpr float kWing = 1.0f / 16;

/// The four-point rule (Dyn, Levin, Gregory 1987). At a corner the line is taken to run straight
/// on, so that corners stay sharp.
Weights BorderRule(const Neighbourhood& mesh, const std::vector<Eigen::Vector3f>& uv, int a,
                   int b) {
  Weights w;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
    w[to] += 0.5f + kWing;
    const std::optional<int> next = mesh.Along(from, to);
    const Eigen::Vector3f ahead =
        next ? Eigen::Vector3f(uv[*next] - uv[to]) : Eigen::Vector3f::Zero();
    const Eigen::Vector3f so_far = uv[to] - uv[from];
    const bool corner = !(ahead.dot(so_far) > 0.5f * ahead.norm() * so_far.norm());
    if (corner) {
      w[to] -= 2 * kWing;
      w[from] += kWing;
    } else {
      w[*next] -= kWing;
    }
  }
  return w;
}

/// The eight-point butterfly. A wing beyond the border is taken to mirror the triangle inside it.
Weights ButterflyRule(const Neighbourhood& mesh, int a, int b) {
  Weights w;
  w[a] += 0.5f;
  w[b] += 0.5f;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
    const int c = *mesh.Opposite(from, to);
    w[c] += 2 * kWing;
    // The edges to -> c and c -> from seen from their other side.
    for (const auto& [p, q, inner] : {std::tuple(to, c, from), std::tuple(c, from, to)}) {
      if (const std::optional<int> wing = mesh.Opposite(q, p)) {
        w[*wing] -= kWing;
      } else {
        w[p] -= kWing;
        w[q] -= kWing;
        w[inner] += kWing;
      }
    }
  }
  return w;
}

/// Zorin's rule beside an inner vertex with other than six neighbours.
Weights ExtraordinaryRule(const Neighbourhood& mesh, int v, int towards) {
  const std::vector<int> ring = mesh.Ring(v, towards);
  const int k = static_cast<int>(ring.size());
  Weights w;
  w[v] = 0.75f;
  for (int j = 0; j < k; ++j) {
    double s = 0;
    if (k == 3) {
      s = j == 0 ? 5.0 / 12 : -1.0 / 12;
    } else if (k == 4) {
      s = j == 0 ? 3.0 / 8 : j == 2 ? -1.0 / 8 : 0;
    } else {
      const double angle = 2 * std::numbers::pi * j / k;
      s = (0.25 + std::cos(angle) + 0.5 * std::cos(2 * angle)) / k;
    }
    w[ring[j]] += static_cast<float>(s);
  }
  return w;
}

Weights MidpointRule(const Neighbourhood& mesh, const std::vector<Eigen::Vector3f>& uv, int a,
                     int b) {
  if (!mesh.Opposite(a, b) || !mesh.Opposite(b, a)) return BorderRule(mesh, uv, a, b);
  Weights sum;
  int rules = 0;
  for (const auto& [v, other] : {std::pair(a, b), std::pair(b, a)}) {
    if (mesh.OnBorder(v) || mesh.Valence(v) == 6) continue;
    ++rules;
    for (const auto& [vertex, weight] : ExtraordinaryRule(mesh, v, other)) sum[vertex] += weight;
  }
  if (rules == 0) return ButterflyRule(mesh, a, b);
  for (auto& [vertex, weight] : sum) weight /= static_cast<float>(rules);
  return sum;
}

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

ClothSurface::ClothSurface(const ClothItem& cloth, int levels)
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
  for (int level = 0; level < levels; ++level) Refine();
}

void ClothSurface::Refine() {
  const Neighbourhood mesh(triangles_, static_cast<int>(uv_layer_.size()));
  std::map<std::pair<int, int>, unsigned> middle_of;
  for (const auto& [edge, c] : mesh.edges()) {
    const int a = std::min(edge.first, edge.second), b = std::max(edge.first, edge.second);
    const auto [entry, is_new] =
        middle_of.try_emplace({a, b}, static_cast<unsigned>(uv_layer_.size()));
    if (!is_new) continue;
    Midpoint midpoint{a, b, static_cast<std::uint32_t>(taps_.size()), 0};
    // The cloth there is what the same stencil takes from the nodes, which is not the edge's middle
    // beside a node with other than six neighbours: so prints lie where they are on flat cloth.
    Eigen::Vector2f uv = Eigen::Vector2f::Zero();
    for (const auto& [vertex, weight] : MidpointRule(mesh, uv_layer_, a, b)) {
      if (weight == 0) continue;
      taps_.push_back({vertex, weight});
      uv += weight * uv_layer_[vertex].head<2>();
    }
    midpoint.taps_end = static_cast<std::uint32_t>(taps_.size());
    midpoints_.push_back(midpoint);
    uv_layer_.emplace_back(uv.x(), uv.y(), uv_layer_[a].z());
  }
  Triangles fine;
  fine.reserve(4 * triangles_.size());
  for (const auto& t : triangles_) {
    std::array<unsigned, 3> middle;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      middle[k] = middle_of.at({std::min(a, b), std::max(a, b)});
    }
    fine.push_back({t[0], middle[0], middle[2]});
    fine.push_back({middle[0], t[1], middle[1]});
    fine.push_back({middle[2], middle[1], t[2]});
    fine.push_back(middle);
  }
  triangles_ = std::move(fine);
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
  positions_.resize(uv_layer_.size());
  for (std::size_t i = 0; i < node_of_.size(); ++i) positions_[i] = cloth.x[node_of_[i]];
  const float floor_z = cloth.floor_z_m + cloth.thickness_m / 2;
  for (std::size_t i = 0; i < midpoints_.size(); ++i) {
    const Midpoint& m = midpoints_[i];
    Eigen::Vector3f p = Eigen::Vector3f::Zero();
    for (std::uint32_t t = m.taps_begin; t < m.taps_end; ++t) {
      p += taps_[t].weight * positions_[taps_[t].vertex];
    }
    // A curve through nodes that lie on the table would dip into it beside a steep wrinkle.
    p.z() = std::max(p.z(), std::min({positions_[m.a].z(), positions_[m.b].z(), floor_z}));
    positions_[node_of_.size() + i] = p;
  }

  normals_.assign(positions_.size(), Eigen::Vector3f::Zero());
  for (const auto& t : triangles_) {
    const Eigen::Vector3f& a = positions_[t[0]];
    const Eigen::Vector3f n = (positions_[t[1]] - a).cross(positions_[t[2]] - a);
    for (const unsigned corner : t) normals_[corner] += n;
  }
  for (Eigen::Vector3f& n : normals_) n.normalize();
}

}  // namespace gusset
