#include "sim/cloth/pair_search.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "sim/cloth/closest_points.h"
#include "sim/cloth/simd8.h"

namespace gusset {
namespace {

using Indices = std::array<int, kLanes8>;

Float8 Length(const Vec3x8& v) { return Sqrt(Dot(v, v)); }

Vec3x8 MaxAbs(const Vec3x8& a, const Vec3x8& b) {
  return {Max(a.x, Abs(b.x)), Max(a.y, Abs(b.y)), Max(a.z, Abs(b.z))};
}

template <class Box>
Float8 Corners(const Box& box) {
  return Float8::Load(box.corners.data());
}

/// What another box touches that begins at or below this.
template <class Box>
Float8 Reach(const Box& box) {
  return Negated(HalvesSwapped(Corners(box)));
}

template <class Box>
bool Touches(Float8 reach, const Box& box) {
  return Bits(Corners(box) <= reach) == 255;
}

template <class Box>
void Include(const Box& other, Box& box) {
  Min(Corners(box), Corners(other)).Store(box.corners.data());
}

}  // namespace

PairSearch::PairSearch(const ClothMesh& mesh) : mesh_(mesh), facing_(mesh) {
  rows_ = static_cast<int>(mesh.patch_rows.size()) / mesh.layers;
  columns_ = static_cast<int>(mesh.patch_rows.front().size());
  for (const auto& row : mesh.patch_rows) patches_.insert(patches_.end(), row.begin(), row.end());
  std::vector<int> layers_at(mesh.rest.size(), 0), last_layer(mesh.rest.size(), -1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const int n : mesh.triangles[t]) {
      layers_at[n] += last_layer[n] != mesh.triangle_layer[t];
      last_layer[n] = mesh.triangle_layer[t];
    }
  }
  for (std::size_t i = 0; i < patches_.size(); ++i) {
    const ClothPatch& patch = patches_[i];
    const int row = static_cast<int>(i) / columns_;
    PatchElements elements{};
    elements.layer = static_cast<std::uint16_t>(row / rows_);
    elements.row = static_cast<std::uint16_t>(row);
    elements.column = static_cast<std::uint16_t>(static_cast<int>(i) % columns_);
    for (const int t : patch.triangles) {
      for (const int n : mesh.triangles[t]) elements.sewn |= layers_at[n] > 1;
    }
    for (const int n : patch.nodes) {
      elements.node[elements.node_count++] = static_cast<std::uint16_t>(n);
    }
    for (const int e : patch.edges) {
      elements.edge[elements.edge_count++] = static_cast<std::uint16_t>(e);
    }
    for (int k = 0; k < 2; ++k) {
      elements.triangle[k] = static_cast<std::uint16_t>(patch.triangles[k]);
    }
    elements_.push_back(elements);
  }
  for (int layer = 0; layer < mesh.layers; ++layer) {
    roots_.push_back(BuildTree(layer * rows_, (layer + 1) * rows_, 0, columns_));
  }
  ListNeighbours();
}

int PairSearch::BuildTree(int row0, int row1, int col0, int col1) {
  TreeNode node;
  if (row1 - row0 == 1 && col1 - col0 == 1) {
    node.patch = row0 * columns_ + col0;
  } else if (row1 - row0 >= col1 - col0) {
    const int mid = (row0 + row1) / 2;
    node.left = BuildTree(row0, mid, col0, col1);
    node.right = BuildTree(mid, row1, col0, col1);
  } else {
    const int mid = (col0 + col1) / 2;
    node.left = BuildTree(row0, row1, col0, mid);
    node.right = BuildTree(row0, row1, mid, col1);
  }
  tree_.push_back(node);
  return static_cast<int>(tree_.size()) - 1;
}

bool PairSearch::AreNeighbours(int a, int b) const {
  const PatchElements &p = elements_[a], &q = elements_[b];
  return p.layer == q.layer && std::abs(p.row - q.row) <= 1 && std::abs(p.column - q.column) <= 1;
}

bool PairSearch::Share(int node, int triangle) const {
  const auto& t = mesh_.triangles[triangle];
  return (node == t[0]) | (node == t[1]) | (node == t[2]);
}

bool PairSearch::ShareEnd(int edge, int other) const {
  const auto &p = mesh_.edges[edge], &q = mesh_.edges[other];
  return (p[0] == q[0]) | (p[0] == q[1]) | (p[1] == q[0]) | (p[1] == q[1]);
}

void PairSearch::ListNeighbours() {
  const auto add_nodes = [&](const ClothPatch& a, const ClothPatch& b) {
    for (const int n : a.nodes) {
      for (const int t : b.triangles) {
        if (Share(n, t)) continue;
        near_node_triangle_.push_back(
            {static_cast<std::uint16_t>(n), static_cast<std::uint16_t>(t)});
      }
    }
  };
  const auto add_edges = [&](int e, int f) {
    if (ShareEnd(e, f)) return;
    near_edges_.push_back({static_cast<std::uint16_t>(e), static_cast<std::uint16_t>(f)});
  };
  const int count = static_cast<int>(patches_.size());
  for (int a = 0; a < count; ++a) {
    // A quad may fold along its diagonal until its own sides meet.
    const ClothPatch& own = patches_[a];
    add_nodes(own, own);
    for (std::size_t i = 0; i < own.edges.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) add_edges(own.edges[j], own.edges[i]);
    }
    for (int b = a + 1; b < std::min(count, a + columns_ + 2); ++b) {
      if (!AreNeighbours(a, b)) continue;
      add_nodes(own, patches_[b]);
      add_nodes(patches_[b], own);
      for (const int e : own.edges) {
        for (const int f : patches_[b].edges) add_edges(e, f);
      }
    }
  }
}

// Boxes of the elements over the whole forecast, margins and half a thickness
// included, and of the tree above them.
void PairSearch::Refit(const MotionForecast& forecast) {
  const float half = 0.5f * mesh_.thickness_m;
  const Vec4Array &start = forecast.start(), &way = forecast.way();
  node_box_.resize(start.size());
  for (std::size_t i = 0; i < start.size(); ++i) {
    const Float4 from = Float4::Load(start[i].data());
    const Float4 to = from + Float4::Load(way[i].data());
    const Float4 grow = half + way[i][3];
    const Float4 lo = Min(from, to) - grow, hi = Max(from, to) + grow;
    Float8(lo, Float4(0.0f) - hi).Store(node_box_[i].corners.data());
  }
  facing_.FindRidges(start, ridge_);
  edge_box_.resize(mesh_.edges.size());
  const Float8 shrink[2] = {half * (1 - kGuardedShare), 0.0f};
  for (std::size_t i = 0; i < mesh_.edges.size(); ++i) {
    Box& box = edge_box_[i];
    box = node_box_[mesh_.edges[i][0]];
    Include(node_box_[mesh_.edges[i][1]], box);
    // What carries no force is watched no further than that.
    (Corners(box) + shrink[ridge_[i]]).Store(box.corners.data());
  }
  triangle_box_.resize(mesh_.triangles.size());
  for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
    const auto& t = mesh_.triangles[i];
    triangle_box_[i] = node_box_[t[0]];
    Include(node_box_[t[1]], triangle_box_[i]);
    Include(node_box_[t[2]], triangle_box_[i]);
  }
  tree_box_.resize(tree_.size());
  for (std::size_t i = 0; i < tree_.size(); ++i) {
    const TreeNode& node = tree_[i];
    if (node.patch >= 0) {
      tree_box_[i] = triangle_box_[patches_[node.patch].triangles[0]];
      Include(triangle_box_[patches_[node.patch].triangles[1]], tree_box_[i]);
    } else {
      tree_box_[i] = tree_box_[node.left];
      Include(tree_box_[node.right], tree_box_[i]);
    }
  }
}

void PairSearch::Self(int node) {
  const TreeNode& n = tree_[node];
  if (n.patch >= 0) return;
  Self(n.left);
  Self(n.right);
  Cross(n.left, n.right);
}

void PairSearch::Cross(int a, int b) {
  if (Touches(Reach(tree_box_[a]), tree_box_[b])) CrossOverlapping(a, b);
}

void PairSearch::CrossOverlapping(int a, int b) {
  const TreeNode &na = tree_[a], &nb = tree_[b];
  if (na.patch >= 0 && nb.patch >= 0) {
    if (AreNeighbours(na.patch, nb.patch)) return;
    // Patches of one layer that do not adjoin share no node.
    const PatchElements &p = elements_[na.patch], &q = elements_[nb.patch];
    if (p.sewn && q.sewn) {
      Patches<true>(p, q);
    } else {
      Patches<false>(p, q);
    }
  } else if (nb.patch >= 0 || (na.patch < 0 && a > b)) {
    Cross(na.left, b);
    Cross(na.right, b);
  } else {
    Cross(a, nb.left);
    Cross(a, nb.right);
  }
}

// `may_share`: some of their elements may have nodes in common, and such do not count.
template <bool may_share>
void PairSearch::Patches(const PatchElements& p, const PatchElements& q) {
  maybe_node_triangle_.Expect(2 * (p.node_count + q.node_count));
  const auto nodes = [&](const PatchElements& of, const PatchElements& with) {
    for (int i = 0; i < of.node_count; ++i) {
      const std::uint16_t n = of.node[i];
      const Float8 reach = Reach(node_box_[n]);
      for (const std::uint16_t t : with.triangle) {
        const bool touch = Touches(reach, triangle_box_[t]);
        maybe_node_triangle_.Offer({n, t}, touch & !(may_share && Share(n, t)));
      }
    }
  };
  nodes(p, q);
  nodes(q, p);
  maybe_edges_.Expect(p.edge_count * q.edge_count);
  for (int i = 0; i < p.edge_count; ++i) {
    const std::uint16_t e = p.edge[i];
    const Float8 reach = Reach(edge_box_[e]);
    for (int j = 0; j < q.edge_count; ++j) {
      const std::uint16_t f = q.edge[j];
      const bool touch = Touches(reach, edge_box_[f]);
      maybe_edges_.Offer({e, f}, touch & !(may_share && ShareEnd(e, f)));
    }
  }
}

void PairSearch::Find(const MotionForecast& forecast, Sieve<ElementPair>& node_triangle,
                      Sieve<ElementPair>& edge_edge) {
  Refit(forecast);
  maybe_node_triangle_.Clear();
  maybe_edges_.Clear();
  maybe_node_triangle_.Expect(near_node_triangle_.size());
  for (const IdPair& p : near_node_triangle_) {
    maybe_node_triangle_.Offer(p, Touches(Reach(node_box_[p[0]]), triangle_box_[p[1]]));
  }
  maybe_edges_.Expect(near_edges_.size());
  for (const IdPair& p : near_edges_) {
    maybe_edges_.Offer(p, Touches(Reach(edge_box_[p[0]]), edge_box_[p[1]]));
  }
  for (std::size_t i = 0; i < roots_.size(); ++i) {
    Self(roots_[i]);
    for (std::size_t j = i + 1; j < roots_.size(); ++j) Cross(roots_[i], roots_[j]);
  }
  node_triangle.Clear();
  edge_edge.Clear();
  MeasureNodeTriangle(forecast, node_triangle);
  MeasureEdgeEdge(forecast, edge_edge);
}

void PairSearch::MeasureNodeTriangle(const MotionForecast& forecast,
                                     Sieve<ElementPair>& out) const {
  const Vec4f *x = forecast.start().data(), *way = forecast.way().data();
  const std::size_t count = maybe_node_triangle_.size();
  out.Expect(count);
  for (std::size_t i = 0; i < count; i += kLanes8) {
    std::array<Indices, 4> n;  // [corner][lane]; node first
    for (std::size_t lane = 0; lane < kLanes8; ++lane) {
      const IdPair& pair = maybe_node_triangle_[std::min(i + lane, count - 1)];
      const auto& t = mesh_.triangles[pair[1]];
      n[0][lane] = pair[0];
      for (int k = 0; k < 3; ++k) n[k + 1][lane] = t[k];
    }
    const auto at = [&](const Vec4f* from, int k, Float8* fourth = nullptr) {
      return Gather(from, n[k], fourth);
    };
    const Vec3x8 p = at(x, 0), a = at(x, 1), b = at(x, 2), c = at(x, 3);
    const Barycentric<Float8> w = ClosestOnTriangle(p, a, b, c);
    const Vec3x8 gap = p - a * w.a - b * w.b - c * w.c;
    const Float8 distance = Length(gap);
    // How far the node can move towards the triangle: their forecasts'
    // difference, and margins.
    Float8 m0, m1, m2, m3;
    const Vec3x8 v = at(way, 0, &m0);
    Vec3x8 relative = MaxAbs({}, v - at(way, 1, &m1));
    relative = MaxAbs(relative, v - at(way, 2, &m2));
    relative = MaxAbs(relative, v - at(way, 3, &m3));
    const Float8 approach = Length(relative) + m0 + Max(m1, Max(m2, m3));
    const int keep = Bits(distance <= approach + mesh_.thickness_m);
    if (keep == 0) continue;
    // A border point that other triangles share stays theirs while the node
    // cannot get over this one.
    const Vec3x8 ab = b - a, ac = c - a;
    const Vec3x8 normal = {ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z,
                           ab.x * ac.y - ab.y * ac.x};
    const Float8 off = Dot(gap, normal);
    const Float8 beside2 = Dot(gap, gap) - off * off / Max(Dot(normal, normal), 1e-20f);
    const int beside = Bits(approach * approach < beside2);
    const int watch = Bits(distance <= approach + mesh_.thickness_m * kGuardedShare);
    alignas(32) float d[kLanes8], wa[kLanes8], wb[kLanes8], wc[kLanes8];
    distance.Store(d);
    w.a.Store(wa);
    w.b.Store(wb);
    w.c.Store(wc);
    for (std::size_t lane = 0; lane < std::min(kLanes8, count - i); ++lane) {
      const int triangle = maybe_node_triangle_[i + lane][1];
      const bool guard =
          (beside >> lane & 1) && !facing_.Owns(triangle, {wa[lane], wb[lane], wc[lane]});
      out.Offer({{static_cast<std::uint16_t>(n[0][lane]), static_cast<std::uint16_t>(n[1][lane]),
                  static_cast<std::uint16_t>(n[2][lane]), static_cast<std::uint16_t>(n[3][lane])},
                 d[lane],
                 {static_cast<std::uint16_t>(n[0][lane]), static_cast<std::uint16_t>(triangle)},
                 false,
                 guard},
                (guard ? watch : keep) >> lane & 1);
    }
  }
}

void PairSearch::MeasureEdgeEdge(const MotionForecast& forecast, Sieve<ElementPair>& out) const {
  const Vec4f *x = forecast.start().data(), *way = forecast.way().data();
  const std::size_t count = maybe_edges_.size();
  out.Expect(count);
  for (std::size_t i = 0; i < count; i += kLanes8) {
    std::array<Indices, 4> n;  // [end][lane]
    alignas(32) float both_ridges[kLanes8];
    for (std::size_t lane = 0; lane < kLanes8; ++lane) {
      const IdPair& pair = maybe_edges_[std::min(i + lane, count - 1)];
      both_ridges[lane] = ridge_[pair[0]] & ridge_[pair[1]] ? 1.0f : 0.0f;
      n[0][lane] = mesh_.edges[pair[0]][0];
      n[1][lane] = mesh_.edges[pair[0]][1];
      n[2][lane] = mesh_.edges[pair[1]][0];
      n[3][lane] = mesh_.edges[pair[1]][1];
    }
    const auto at = [&](const Vec4f* from, int k, Float8* fourth = nullptr) {
      return Gather(from, n[k], fourth);
    };
    const Vec3x8 a = at(x, 0), b = at(x, 1), c = at(x, 2), d = at(x, 3);
    const SegmentPoints<Float8> w = ClosestOnSegments(a, b, c, d);
    const Float8 distance = Length(a + (b - a) * w.s - c - (d - c) * w.t);
    Float8 m0, m1, m2, m3;
    const Vec3x8 va = at(way, 0, &m0), vb = at(way, 1, &m1), vc = at(way, 2, &m2),
                 vd = at(way, 3, &m3);
    Vec3x8 relative = MaxAbs({}, va - vc);
    relative = MaxAbs(relative, va - vd);
    relative = MaxAbs(relative, vb - vc);
    relative = MaxAbs(relative, vb - vd);
    const Float8 approach = Length(relative) + Max(m0, m1) + Max(m2, m3);
    // An end of an edge is a node, and node against triangle carries its contact, as it does where
    // cloth is flat.
    const Float8 ridges = Float8::Load(both_ridges);
    const Float8 inner =
        (Float8(0.0f) < w.s) & (w.s < Float8(1.0f)) & (Float8(0.0f) < w.t) & (w.t < Float8(1.0f));
    const Float8 force = inner & (Float8(0.0f) < ridges);
    const Float8 near = Select(force, mesh_.thickness_m, mesh_.thickness_m * kGuardedShare);
    const int keep = Bits(distance <= approach + near);
    if (keep == 0) continue;
    alignas(32) float length[kLanes8];
    distance.Store(length);
    for (std::size_t lane = 0; lane < std::min(kLanes8, count - i); ++lane) {
      out.Offer({{static_cast<std::uint16_t>(n[0][lane]), static_cast<std::uint16_t>(n[1][lane]),
                  static_cast<std::uint16_t>(n[2][lane]), static_cast<std::uint16_t>(n[3][lane])},
                 length[lane],
                 maybe_edges_[i + lane],
                 true,
                 !(Bits(force) >> lane & 1)},
                keep >> lane & 1);
    }
  }
}

}  // namespace gusset
