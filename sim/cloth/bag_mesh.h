#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "sim/cloth/bag_config.h"

namespace gusset {

/// A distance constraint between two nodes.
struct ClothLink {
  int a = 0;
  int b = 0;
  float rest_m = 0;
};

/// A warp or weft yarn from border to border of its layer.
struct ClothYarn {
  std::vector<int> nodes;
  float rest_m = 0;  ///< From node to node.
};

/// Three nodes in a row of the weave; its second difference is the row's bending.
struct ClothBend {
  int a = 0;
  int mid = 0;
  int c = 0;
  float stiffness_N_m = 0;  ///< B w / L^3 for a strip of width w and node distance L.
  float friction_N = 0;     ///< Most that internal friction takes: stiffness times kappa L^2.
};

/// A quad of the cloth with the elements it owns, so that every node, edge and triangle of the mesh
/// belongs to exactly one patch. Leaves of the contact search.
struct ClothPatch {
  std::vector<int> nodes;
  std::vector<int> edges;
  std::vector<int> triangles;
};

/// The flat pattern of a cloth: nodes, triangles, links.
///
/// Cloth coordinates: u across (0 .. opening), v from the rim (0) to the bottom, metres. A bag has
/// two layers, 0 below and 1 above as it is laid out, whose nodes at u = 0, u = opening and v =
/// depth are shared: the seams.
struct ClothMesh {
  int layers = 0;
  float thickness_m = 0;
  std::vector<Eigen::Vector3f> rest;  ///< Flat layout: (u, v, height), layers one thickness apart.
  std::vector<Eigen::Vector2f> uv;    ///< Per node, m.
  std::vector<float> mass_kg;         ///< Per node.
  std::vector<std::array<int, 3>> triangles;
  std::vector<std::uint8_t> triangle_layer;
  std::vector<std::array<int, 2>> edges;  ///< Every triangle edge once.
  std::vector<ClothLink> stretch;         ///< Along warp and weft.
  std::vector<ClothYarn> yarns;           ///< The same links as chains.
  std::vector<ClothLink> shear;           ///< Both diagonals of each quad.
  std::vector<ClothBend> bends;
  std::vector<std::vector<ClothPatch>> patch_rows;  ///< [layer * rows + row][column].

  int node_count() const { return static_cast<int>(rest.size()); }
};

/// Two layers sewn on three sides. The rim's hem doubles the mass and bending of its row.
ClothMesh MakeBagMesh(const BagConfig& config);

/// One rectangular layer, for tests against closed forms. width across u, length along v.
ClothMesh MakeSheetMesh(const BagConfig& config);

}  // namespace gusset
