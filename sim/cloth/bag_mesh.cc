#include "sim/cloth/bag_mesh.h"

#include <map>

namespace gusset {
namespace {

// Hem: the rim is folded over once, so its edge row carries twice the cloth.
constexpr float kHemFactor = 2.0f;

ClothMesh MakeMesh(const BagConfig& config, int layers) {
  const int nu = config.nodes_across;
  const int nv = config.nodes_deep;
  const float du = static_cast<float>(config.opening_m) / static_cast<float>(nu - 1);
  const float dv = static_cast<float>(config.depth_m) / static_cast<float>(nv - 1);
  const float half_gap = 0.5f * static_cast<float>(config.thickness_m);
  ClothMesh mesh;
  mesh.layers = layers;
  mesh.thickness_m = static_cast<float>(config.thickness_m);

  // Node ids per layer; seam nodes of layer 1 are those of layer 0.
  std::vector<std::vector<int>> id(static_cast<std::size_t>(layers), std::vector<int>(nu * nv));
  const auto is_seam = [&](int i, int j) {
    return layers == 2 && (i == 0 || i == nu - 1 || j == nv - 1);
  };
  for (int layer = 0; layer < layers; ++layer) {
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        if (layer == 1 && is_seam(i, j)) {
          id[1][j * nu + i] = id[0][j * nu + i];
          continue;
        }
        const float height = layers == 1 || is_seam(i, j) ? 0.0f
                             : layer == 0                 ? -half_gap
                                                          : half_gap;
        id[layer][j * nu + i] = mesh.node_count();
        mesh.rest.emplace_back(du * static_cast<float>(i), dv * static_cast<float>(j), height);
        mesh.uv.emplace_back(du * static_cast<float>(i), dv * static_cast<float>(j));
      }
    }
  }
  mesh.mass_kg.assign(mesh.rest.size(), 0.0f);

  std::map<std::array<int, 2>, int> edge_ids;
  std::map<std::array<int, 3>, bool> bends_done;
  std::vector<bool> node_owned(mesh.rest.size(), false);
  const auto own_edge = [&](int a, int b, ClothPatch& patch) {
    const std::array<int, 2> key = {std::min(a, b), std::max(a, b)};
    if (edge_ids.emplace(key, static_cast<int>(mesh.edges.size())).second) {
      patch.edges.push_back(static_cast<int>(mesh.edges.size()));
      mesh.edges.push_back(key);
    }
  };
  const auto link = [&](int a, int b, std::vector<ClothLink>& links, float rest) {
    links.push_back({a, b, rest});
  };

  std::map<std::array<int, 2>, bool> linked;
  const float density = static_cast<float>(config.area_density_kg_m2);
  const float rigidity = static_cast<float>(config.flexural_rigidity_Nm);
  for (int layer = 0; layer < layers; ++layer) {
    const auto node = [&](int i, int j) { return id[layer][j * nu + i]; };
    for (int j = 0; j + 1 < nv; ++j) {
      std::vector<ClothPatch> row;
      for (int i = 0; i + 1 < nu; ++i) {
        const int n00 = node(i, j), n10 = node(i + 1, j), n01 = node(i, j + 1),
                  n11 = node(i + 1, j + 1);
        ClothPatch patch;
        // Diagonals alternate so that no direction is favoured; the layers take
        // opposite ones.
        const bool forward = (i + j + layer) % 2 == 0;
        const std::array<std::array<int, 3>, 2> tris =
            forward ? std::array<std::array<int, 3>, 2>{{{n00, n10, n11}, {n00, n11, n01}}}
                    : std::array<std::array<int, 3>, 2>{{{n00, n10, n01}, {n10, n11, n01}}};
        for (const auto& t : tris) {
          patch.triangles.push_back(static_cast<int>(mesh.triangles.size()));
          mesh.triangles.push_back(t);
          mesh.triangle_layer.push_back(static_cast<std::uint8_t>(layer));
        }
        for (const int n : {n00, n10, n01, n11}) {
          const bool rim = j == 0 && (n == n00 || n == n10);
          mesh.mass_kg[n] += 0.25f * density * du * dv * (rim ? kHemFactor : 1.0f);
          if (!node_owned[n]) {
            node_owned[n] = true;
            patch.nodes.push_back(n);
          }
        }
        own_edge(n00, n10, patch);
        own_edge(n00, n01, patch);
        own_edge(n10, n11, patch);
        own_edge(n01, n11, patch);
        own_edge(forward ? n00 : n10, forward ? n11 : n01, patch);
        const float diagonal = std::sqrt(du * du + dv * dv);
        link(n00, n11, mesh.shear, diagonal);
        link(n10, n01, mesh.shear, diagonal);
        row.push_back(std::move(patch));
      }
      mesh.patch_rows.push_back(std::move(row));
    }
    // Warp and weft. A seam link shared by both layers exists once.
    const auto link_once = [&](int a, int b, float rest) {
      if (linked.emplace(std::array<int, 2>{std::min(a, b), std::max(a, b)}, true).second) {
        link(a, b, mesh.stretch, rest);
      }
    };
    // Neighbours in the list belong to neighbouring rows and share no node (see
    // LinkSolver).
    for (int i = 0; i + 1 < nu; ++i) {
      for (int j = 0; j < nv; ++j) link_once(node(i, j), node(i + 1, j), du);
    }
    for (int j = 0; j + 1 < nv; ++j) {
      for (int i = 0; i < nu; ++i) link_once(node(i, j), node(i, j + 1), dv);
    }
    // Those of the seams are layer 0's.
    for (int j = 0; j < nv; ++j) {
      if (layer == 1 && is_seam(1, j)) continue;
      ClothYarn& weft = mesh.yarns.emplace_back();
      weft.rest_m = du;
      for (int i = 0; i < nu; ++i) weft.nodes.push_back(node(i, j));
    }
    for (int i = 0; i < nu; ++i) {
      if (layer == 1 && is_seam(i, 0)) continue;
      ClothYarn& warp = mesh.yarns.emplace_back();
      warp.rest_m = dv;
      for (int j = 0; j < nv; ++j) warp.nodes.push_back(node(i, j));
    }
    // Bending of a row of strips, each as wide as the spacing across: energy B
    // w/(2 L^3) |x1-2x2+x3|^2.
    const float residual = static_cast<float>(config.residual_curvature_1_m);
    const auto bend = [&](int a, int mid, int c, float width, float length) {
      const float stiffness = rigidity * width / (length * length * length);
      if (bends_done.emplace(std::array<int, 3>{a, mid, c}, true).second) {
        mesh.bends.push_back({a, mid, c, stiffness, stiffness * residual * length * length});
      }
    };
    for (int j = 0; j < nv; ++j) {
      for (int i = 0; i + 2 < nu; ++i) {
        const float width = (j == 0 ? 0.5f * kHemFactor : j == nv - 1 ? 0.5f : 1.0f) * dv;
        bend(node(i, j), node(i + 1, j), node(i + 2, j), width, du);
      }
    }
    for (int j = 0; j + 2 < nv; ++j) {
      for (int i = 0; i < nu; ++i) {
        const float width = (i == 0 || i == nu - 1 ? 0.5f : 1.0f) * du;
        bend(node(i, j), node(i, j + 1), node(i, j + 2), width, dv);
      }
    }
  }
  return mesh;
}

}  // namespace

ClothMesh MakeBagMesh(const BagConfig& config) { return MakeMesh(config, 2); }

ClothMesh MakeSheetMesh(const BagConfig& config) { return MakeMesh(config, 1); }

}  // namespace gusset
