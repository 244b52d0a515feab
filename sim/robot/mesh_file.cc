#include "sim/robot/mesh_file.h"

#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <assimp/Importer.hpp>

#include "base/error.h"

namespace gusset {
namespace {

void Append(const aiScene& scene, const aiNode& node, const aiMatrix4x4& X_FP,
            const std::filesystem::path& file, std::vector<MeshPart>& parts) {
  const aiMatrix4x4 X_FN = X_FP * node.mTransformation;
  for (unsigned m = 0; m < node.mNumMeshes; ++m) {
    const aiMesh& source = *scene.mMeshes[node.mMeshes[m]];
    MeshPart part;
    for (unsigned i = 0; i < source.mNumVertices; ++i) {
      const aiVector3D v = X_FN * source.mVertices[i];
      const Eigen::Vector3f vertex(v.x, v.y, v.z);
      if (!vertex.allFinite()) {
        throw InputError(file.string() + ": vertex " + std::to_string(i) + " is not finite");
      }
      part.mesh.vertices.push_back(vertex);
    }
    for (unsigned i = 0; i < source.mNumFaces; ++i) {
      const aiFace& face = source.mFaces[i];
      if (face.mNumIndices != 3) continue;  // points and lines
      part.mesh.triangles.push_back({static_cast<int>(face.mIndices[0]),
                                     static_cast<int>(face.mIndices[1]),
                                     static_cast<int>(face.mIndices[2])});
    }
    aiColor3D diffuse;
    if (scene.mMaterials[source.mMaterialIndex]->Get(AI_MATKEY_COLOR_DIFFUSE, diffuse) ==
        AI_SUCCESS) {
      part.colour = Eigen::Vector3f(diffuse.r, diffuse.g, diffuse.b);
    }
    if (!part.mesh.triangles.empty()) parts.push_back(std::move(part));
  }
  for (unsigned c = 0; c < node.mNumChildren; ++c) {
    Append(scene, *node.mChildren[c], X_FN, file, parts);
  }
}

}  // namespace

std::vector<MeshPart> LoadMeshFile(const std::filesystem::path& file) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(file, none)) {
    throw InputError(file.string() + ": no such mesh file");
  }
  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_JoinIdenticalVertices);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    throw InputError(file.string() + ": cannot be read as a mesh: " + importer.GetErrorString());
  }
  std::vector<MeshPart> parts;
  Append(*scene, *scene->mRootNode, aiMatrix4x4(), file, parts);
  if (parts.empty()) throw InputError(file.string() + ": holds no triangle");
  return parts;
}

}  // namespace gusset
