#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <vector>

#include "sim/tri_mesh.h"

namespace gusset {

/// One part of a mesh file; files with several materials have several.
struct MeshPart {
  TriMesh mesh;
  std::optional<Eigen::Vector3f> colour;  ///< Diffuse colour if the file states one.
};

/// Reads any format that assimp knows, with the file's node transforms applied.
/// @throws InputError naming the file if it cannot be read, holds no triangle or a number in it is
///   not finite.
std::vector<MeshPart> LoadMeshFile(const std::filesystem::path& file);

}  // namespace gusset
