#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "base/random.h"
#include "sim/cloth/closest_points.h"
#include "sim/cloth/pair_search.h"

namespace gusset {
namespace {

using Nodes = std::array<std::uint16_t, 4>;

// A bag rolled up along a spiral whose turns are 4 mm apart, shaken by a millimetre: layers and
// turns everywhere within reach of each other, no two nodes of them in one place.
Vec4Array Rolled(const ClothMesh& mesh, std::uint64_t seed) {
  Rng rng(seed);
  Vec4Array x;
  for (const Eigen::Vector3f& p : mesh.rest) {
    const float angle = std::sqrt(2 * p.y() / 0.00064f + 100);
    const float radius = 0.00064f * angle + p.z();
    const auto shake = [&] { return static_cast<float>(rng.Uniform(-0.0005, 0.0005)); };
    const float u = p.x() + shake(), v = radius * std::cos(angle) + shake();
    x.emplace_back(u, v, radius * std::sin(angle) + shake(), 0.0f);
  }
  return x;
}

struct Lists {
  std::map<Nodes, float> node_triangle, edge_edge;  // distances
};

Lists Found(const ClothMesh& mesh, const Vec4Array& x, float margin_m) {
  MotionForecast still;
  still.Start({0.01f, margin_m, 0, 0}, x, Vec4Array(x.size(), Vec4f::Zero()));
  Sieve<ElementPair> node_triangle, edge_edge;
  PairSearch(mesh).Find(still, node_triangle, edge_edge);
  Lists lists;
  for (std::size_t i = 0; i < node_triangle.size(); ++i) {
    lists.node_triangle[node_triangle[i].node] = node_triangle[i].distance_m;
  }
  for (std::size_t i = 0; i < edge_edge.size(); ++i) {
    lists.edge_edge[edge_edge[i].node] = edge_edge[i].distance_m;
  }
  EXPECT_EQ(lists.node_triangle.size(), node_triangle.size()) << "a pair is listed twice";
  EXPECT_EQ(lists.edge_edge.size(), edge_edge.size()) << "a pair is listed twice";
  return lists;
}

float First(Float4 v) {
  alignas(16) std::array<float, 4> lanes;
  v.Store(lanes.data());
  return lanes[0];
}

Vec3x4 Everywhere(const Vec4f& p) { return {p.x(), p.y(), p.z()}; }

// Every node against every triangle, every edge against every edge.
Lists All(const ClothMesh& mesh, const Vec4Array& x, float reach_m) {
  Lists lists;
  const auto id = [](int n) { return static_cast<std::uint16_t>(n); };
  for (int n = 0; n < mesh.node_count(); ++n) {
    for (const auto& t : mesh.triangles) {
      if (n == t[0] || n == t[1] || n == t[2]) continue;
      const Barycentric4 w = ClosestOnTriangle(Everywhere(x[n]), Everywhere(x[t[0]]),
                                               Everywhere(x[t[1]]), Everywhere(x[t[2]]));
      // What lies beside a triangle may be a neighbour's.
      if (First(w.a) <= 0 || First(w.b) <= 0 || First(w.c) <= 0) continue;
      const Vec4f gap = x[n] - First(w.a) * x[t[0]] - First(w.b) * x[t[1]] - First(w.c) * x[t[2]];
      if (gap.norm() < reach_m) {
        lists.node_triangle[{id(n), id(t[0]), id(t[1]), id(t[2])}] = gap.norm();
      }
    }
  }
  for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
    for (std::size_t j = i + 1; j < mesh.edges.size(); ++j) {
      const auto &p = mesh.edges[i], &q = mesh.edges[j];
      if (p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1]) continue;
      const Vec4f middle = 0.5f * (x[p[0]] + x[p[1]] - x[q[0]] - x[q[1]]);
      if (middle.norm() > 0.06f) continue;  // no edge is longer than that
      const SegmentPoints4 w = ClosestOnSegments(Everywhere(x[p[0]]), Everywhere(x[p[1]]),
                                                 Everywhere(x[q[0]]), Everywhere(x[q[1]]));
      const float s = First(w.s), t = First(w.t);
      if (s <= 0 || s >= 1 || t <= 0 || t >= 1) continue;
      const Vec4f gap = x[p[0]] + s * (x[p[1]] - x[p[0]]) - x[q[0]] - t * (x[q[1]] - x[q[0]]);
      if (gap.norm() < reach_m) {
        lists.edge_edge[{id(p[0]), id(p[1]), id(q[0]), id(q[1])}] = gap.norm();
      }
    }
  }
  return lists;
}

// As listed, or the other element first.
const float* Find(const std::map<Nodes, float>& in, const Nodes& n) {
  for (const Nodes& key : {n, Nodes{n[2], n[3], n[0], n[1]}}) {
    if (const auto it = in.find(key); it != in.end()) return &it->second;
  }
  return nullptr;
}

// The tree against all pairs: nothing within reach is missed, sewn borders included.
TEST(PairSearch, FindsWhatComparingAllWithAllFinds) {
  BagConfig bag;
  bag.nodes_across = 12;
  const ClothMesh mesh = MakeBagMesh(bag);
  constexpr float kMargin_m = 0.001f;
  for (const std::uint64_t seed : {1, 2}) {
    const Vec4Array x = Rolled(mesh, seed);
    const Lists found = Found(mesh, x, kMargin_m);
    const Lists all = All(mesh, x, mesh.thickness_m + 2 * kMargin_m - 1e-6f);
    ASSERT_GT(all.node_triangle.size(), 100u);
    ASSERT_GT(all.edge_edge.size(), 100u);
    for (const auto& [nodes, distance] : all.node_triangle) {
      const float* listed = Find(found.node_triangle, nodes);
      ASSERT_NE(listed, nullptr) << nodes[0] << " against " << nodes[1];
      EXPECT_NEAR(*listed, distance, 1e-6f);
    }
    for (const auto& [nodes, distance] : all.edge_edge) {
      const float* listed = Find(found.edge_edge, nodes);
      ASSERT_NE(listed, nullptr) << nodes[0] << " against " << nodes[2];
      EXPECT_NEAR(*listed, distance, 1e-6f);
    }
  }
}

TEST(PairSearch, ListsNoElementsThatShareANodeAndNoneOutOfReach) {
  const ClothMesh mesh = MakeBagMesh({});
  constexpr float kMargin_m = 0.001f;
  const Lists found = Found(mesh, Rolled(mesh, 3), kMargin_m);
  for (const auto* list : {&found.node_triangle, &found.edge_edge}) {
    for (const auto& [nodes, distance] : *list) {
      EXPECT_EQ(std::set<int>(nodes.begin(), nodes.end()).size(), 4u);
      EXPECT_LT(distance, mesh.thickness_m + 2 * kMargin_m + 1e-6f);
    }
  }
}

}  // namespace
}  // namespace gusset
