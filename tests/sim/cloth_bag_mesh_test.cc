#include <gtest/gtest.h>

#include <numeric>

#include "sim/cloth/bag_mesh.h"

namespace gusset {
namespace {

double Total(const std::vector<float>& a) { return std::accumulate(a.begin(), a.end(), 0.0); }

TEST(BagMesh, HasTheLayersSewnOnThreeSides) {
  const BagConfig bag;
  const ClothMesh mesh = MakeBagMesh(bag);
  const int per_layer = bag.nodes_across * bag.nodes_deep;
  const int seam = 2 * bag.nodes_deep + bag.nodes_across - 2;
  EXPECT_EQ(mesh.node_count(), 2 * per_layer - seam);
  EXPECT_GE(mesh.node_count(), 500);
  // A closed seam and an open rim make the bag a disc: vertices - edges + faces = 1.
  EXPECT_EQ(mesh.node_count() - static_cast<int>(mesh.edges.size()) +
                static_cast<int>(mesh.triangles.size()),
            1);
}

TEST(BagMesh, CoversBothLayersAndWeighsThemWithTheHem) {
  const BagConfig bag;
  const ClothMesh mesh = MakeBagMesh(bag);
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector2f a = mesh.uv[t[1]] - mesh.uv[t[0]], b = mesh.uv[t[2]] - mesh.uv[t[0]];
    area += 0.5 * std::abs(a.x() * b.y() - a.y() * b.x());
  }
  const double flat = 2 * bag.opening_m * bag.depth_m;
  EXPECT_NEAR(area, flat, 1e-6);  // float sums
  // The hem doubles the half row of cloth along each rim.
  const double hem = 2 * bag.opening_m * 0.5 * bag.depth_m / (bag.nodes_deep - 1);
  EXPECT_NEAR(Total(mesh.mass_kg), bag.area_density_kg_m2 * (flat + hem), 1e-6);
}

TEST(BagMesh, GivesEveryElementToExactlyOnePatch) {
  const ClothMesh mesh = MakeBagMesh(BagConfig{});
  std::vector<int> nodes(mesh.rest.size()), edges(mesh.edges.size()), faces(mesh.triangles.size());
  for (const auto& row : mesh.patch_rows) {
    for (const ClothPatch& patch : row) {
      for (const int n : patch.nodes) ++nodes[n];
      for (const int e : patch.edges) ++edges[e];
      for (const int t : patch.triangles) ++faces[t];
    }
  }
  for (const auto* counts : {&nodes, &edges, &faces}) {
    for (const int count : *counts) EXPECT_EQ(count, 1);
  }
}

}  // namespace
}  // namespace gusset
