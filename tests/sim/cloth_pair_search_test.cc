#include <gtest/gtest.h>

#include <map>
#include <set>

#include "base/random.h"
#include "sim/cloth/closest_points.h"
#include "sim/cloth/pair_search.h"

namespace gusset {
namespace {

using Nodes = std::array<std::uint16_t, 4>;

constexpr float kMargin_m = 0.001f;

// Nodes anywhere in a cube of 0.1 m: elements of all layers and rows, adjoining ones too, within
// reach of each other.
Vec4Array Scattered(const ClothMesh& mesh, std::uint64_t seed) {
  Rng rng(seed);
  const auto draw = [&] { return static_cast<float>(rng.Uniform(-0.05, 0.05)); };
  Vec4Array x;
  for (int i = 0; i < mesh.node_count(); ++i) {
    const float u = draw(), v = draw(), w = draw();
    x.emplace_back(u, v, w, 0.0f);
  }
  return x;
}

struct Pair {
  float distance_m;
  bool guard, inner;  ///< inner: the closest points are no border points, and no flat edge's.
};

struct Lists {
  std::map<Nodes, Pair> node_triangle, edge_edge;
};

// What the search lists for a cloth at rest whose nodes may be off by kMargin_m.
Lists Found(const ClothMesh& mesh, const Vec4Array& x) {
  MotionForecast still;
  still.Start({0.01f, kMargin_m, 0, 0}, x, Vec4Array(x.size(), Vec4f::Zero()));
  Sieve<ElementPair> node_triangle, edge_edge;
  PairSearch(mesh).Find(still, node_triangle, edge_edge);
  Lists lists;
  const auto copy = [](const Sieve<ElementPair>& from, std::map<Nodes, Pair>& to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      to[from[i].node] = {from[i].distance_m, from[i].guard, false};
    }
    EXPECT_EQ(to.size(), from.size()) << "a pair is listed twice";
  };
  copy(node_triangle, lists.node_triangle);
  copy(edge_edge, lists.edge_edge);
  return lists;
}

float First(Float4 v) {
  alignas(16) std::array<float, 4> lanes;
  v.Store(lanes.data());
  return lanes[0];
}

Vec3x4 Everywhere(const Vec4f& p) { return {p.x(), p.y(), p.z()}; }

// Edges where triangles meet at an angle, or only one is.
std::vector<bool> Ridges(const ClothMesh& mesh, const Vec4Array& x) {
  std::vector<bool> ridges;
  for (const auto& e : mesh.edges) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int triangles = 0;
    for (const auto& t : mesh.triangles) {
      const auto has = [&](int n) { return n == t[0] || n == t[1] || n == t[2]; };
      if (!has(e[0]) || !has(e[1])) continue;
      const auto at = [&](int n) { return Eigen::Vector3d(x[n].head<3>().cast<double>()); };
      const Eigen::Vector3d along = (at(e[1]) - at(e[0])).normalized();
      const Eigen::Vector3d to = at(t[0] + t[1] + t[2] - e[0] - e[1]) - at(e[0]);
      sum += (to - along * to.dot(along)).normalized();
      ++triangles;
    }
    ridges.push_back(triangles == 1 || sum.norm() > 2 * 0.2 * Facing(mesh).ridge_sine());
  }
  return ridges;
}

// Every node against every triangle, every edge against every edge, that share no node.
Lists All(const ClothMesh& mesh, const Vec4Array& x) {
  Lists lists;
  const auto id = [](int n) { return static_cast<std::uint16_t>(n); };
  for (int n = 0; n < mesh.node_count(); ++n) {
    for (const auto& t : mesh.triangles) {
      if (n == t[0] || n == t[1] || n == t[2]) continue;
      const Barycentric<Float4> at = ClosestOnTriangle(Everywhere(x[n]), Everywhere(x[t[0]]),
                                                       Everywhere(x[t[1]]), Everywhere(x[t[2]]));
      const float a = First(at.a), b = First(at.b), c = First(at.c);
      const Vec4f gap = x[n] - a * x[t[0]] - b * x[t[1]] - c * x[t[2]];
      lists.node_triangle[{id(n), id(t[0]), id(t[1]), id(t[2])}] = {gap.norm(), false,
                                                                    a > 0 && b > 0 && c > 0};
    }
  }
  const std::vector<bool> ridge = Ridges(mesh, x);
  for (std::size_t i = 0; i < mesh.edges.size(); ++i) {
    for (std::size_t j = i + 1; j < mesh.edges.size(); ++j) {
      const auto &p = mesh.edges[i], &q = mesh.edges[j];
      if (p[0] == q[0] || p[0] == q[1] || p[1] == q[0] || p[1] == q[1]) continue;
      const SegmentPoints<Float4> at = ClosestOnSegments(Everywhere(x[p[0]]), Everywhere(x[p[1]]),
                                                         Everywhere(x[q[0]]), Everywhere(x[q[1]]));
      const float s = First(at.s), t = First(at.t);
      const Vec4f gap = x[p[0]] + s * (x[p[1]] - x[p[0]]) - x[q[0]] - t * (x[q[1]] - x[q[0]]);
      lists.edge_edge[{id(p[0]), id(p[1]), id(q[0]), id(q[1])}] = {
          gap.norm(), false, s > 0 && s < 1 && t > 0 && t < 1 && ridge[i] && ridge[j]};
    }
  }
  return lists;
}

// As listed, or the other element first.
const Pair* Find(const std::map<Nodes, Pair>& in, const Nodes& n, bool edges) {
  auto it = in.find(n);
  if (it == in.end() && edges) it = in.find({n[2], n[3], n[0], n[1]});
  return it == in.end() ? nullptr : &it->second;
}

// The tree against all pairs: what meets between borders is listed within a thickness and both
// margins, what meets at a border or a flat edge within a fifth of the thickness, and nothing
// beyond.
TEST(PairSearch, ListsWhatComparingAllWithAllFindsWithinReach) {
  BagConfig bag;
  bag.nodes_across = 12;
  const ClothMesh mesh = MakeBagMesh(bag);
  const float reach_m = mesh.thickness_m + 2 * kMargin_m;
  const float guarded_m = kGuardedShare * mesh.thickness_m + 2 * kMargin_m;
  for (const std::uint64_t seed : {1, 2}) {
    const Vec4Array x = Scattered(mesh, seed);
    const Lists found = Found(mesh, x), all = All(mesh, x);
    for (const bool edges : {false, true}) {
      const auto& listed = edges ? found.edge_edge : found.node_triangle;
      int inner = 0, border = 0, guards = 0;
      for (const auto& [nodes, pair] : edges ? all.edge_edge : all.node_triangle) {
        const bool near = pair.distance_m < (pair.inner ? reach_m : guarded_m) - 1e-6f;
        const Pair* in_list = Find(listed, nodes, edges);
        if (near) {
          ASSERT_NE(in_list, nullptr) << nodes[0] << ' ' << nodes[1] << ' ' << nodes[2];
          ++(pair.inner ? inner : border);
        }
        if (!in_list) continue;
        guards += in_list->guard;
        EXPECT_NEAR(in_list->distance_m, pair.distance_m, 1e-6f);
        EXPECT_LT(pair.distance_m, (in_list->guard ? guarded_m : reach_m) + 1e-6f);
        EXPECT_FALSE(in_list->guard && pair.inner) << "no other pair carries this contact's force";
        if (edges) {
          EXPECT_NE(in_list->guard, pair.inner);
        }
      }
      EXPECT_GT(inner, 100);
      EXPECT_GT(border, 100);
      EXPECT_GT(guards, edges ? 100 : 10);  // few nodes are beside triangles out of all reach
    }
  }
}

TEST(PairSearch, ListsNoElementsThatShareANode) {
  const ClothMesh mesh = MakeBagMesh({});
  const Lists found = Found(mesh, Scattered(mesh, 3));
  for (const auto* list : {&found.node_triangle, &found.edge_edge}) {
    for (const auto& [nodes, pair] : *list) {
      EXPECT_EQ(std::set<int>(nodes.begin(), nodes.end()).size(), 4u);
    }
  }
}

}  // namespace
}  // namespace gusset
