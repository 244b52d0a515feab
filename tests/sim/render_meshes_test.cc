// The arm's meshes as they lie in assets/: what make_meshes.py promises.

#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "sim/render/mesh_normals.h"
#include "sim/render/statics.h"

namespace gusset {
namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(GUSSET_SOURCE_DIR) / "assets/robots/iiwa14_2f85/meshes/visual";

/// Read here, not with assimp, which may join or split vertices.
TriMesh ReadObj(const std::filesystem::path& file) {
  TriMesh mesh;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string kind;
    words >> kind;
    if (kind == "v") {
      Eigen::Vector3f v;
      words >> v.x() >> v.y() >> v.z();
      mesh.vertices.push_back(v);
    } else if (kind == "f") {
      std::array<int, 3> t;
      words >> t[0] >> t[1] >> t[2];
      mesh.triangles.push_back({t[0] - 1, t[1] - 1, t[2] - 1});
    }
    EXPECT_FALSE(words.fail()) << file << ": " << line;
  }
  return mesh;
}

std::map<std::string, TriMesh> AllMeshes() {
  std::map<std::string, TriMesh> meshes;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    meshes[entry.path().stem()] = ReadObj(entry.path());
  }
  return meshes;
}

/// Each edge is used once in each direction: closed, and wound the same way all over.
void ExpectClosed(const TriMesh& mesh) {
  std::map<std::pair<int, int>, int> uses;
  for (const auto& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++uses[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : uses) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(uses.contains({edge.second, edge.first}));
  }
}

/// Six times the enclosed volume; positive if the normals point outward.
double SignedVolume(const TriMesh& mesh) {
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Eigen::Vector3d a = mesh.vertices[t[0]].cast<double>();
    volume += a.dot(mesh.vertices[t[1]].cast<double>().cross(mesh.vertices[t[2]].cast<double>()));
  }
  return volume;
}

TEST(Meshes, AreClosedAndFaceOutward) {
  const auto meshes = AllMeshes();
  ASSERT_EQ(meshes.size(), 16u);
  for (const auto& [name, mesh] : meshes) {
    SCOPED_TRACE(name);
    ExpectClosed(mesh);
    EXPECT_GT(SignedVolume(mesh), 0);
  }
}

TEST(Meshes, StayWithinTheBudgetOfTriangles) {
  std::size_t total = 0;
  for (const auto& [name, mesh] : AllMeshes()) {
    const bool twice = name.starts_with("finger");
    total += mesh.triangles.size() * (twice ? 2 : 1);
  }
  EXPECT_LE(total, 10000u);
}

TEST(Meshes, FingerLiesWhereTheGripperExpectsIt) {
  const auto meshes = AllMeshes();
  for (const char* name : {"finger", "finger_pad"}) {
    for (const Eigen::Vector3f& v : meshes.at(name).vertices) {
      EXPECT_GE(v.x(), 0);
      EXPECT_LE(v.x(), 0.012f);
      EXPECT_LE(std::abs(v.y()), 0.0111f);
      EXPECT_LE(v.z(), 0);
      EXPECT_GE(v.z(), -0.1001f);
    }
  }
}

TEST(MeshNormals, RoundOffABoxOnlyBeyondTheCrease) {
  const TriMesh box = BoxMesh({1, 1, 1});
  ExpectClosed(box);
  EXPECT_DOUBLE_EQ(SignedVolume(box), 6);
  const ShadedMesh sharp = WithNormals(box, 40);
  EXPECT_EQ(sharp.vertices.size(), 24u);  // three normals at each corner
  for (const ShadedMesh::Vertex& v : sharp.vertices) EXPECT_EQ(v.normal.cwiseAbs().maxCoeff(), 1);
  const ShadedMesh round = WithNormals(box, 100);
  for (const ShadedMesh::Vertex& v : round.vertices) EXPECT_GT(v.normal.dot(v.position), 0.8f);
}

}  // namespace
}  // namespace gusset
