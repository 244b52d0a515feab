#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/tri_mesh.h"

namespace gusset {

/// A convex primitive of a link.
struct CollisionShape {
  enum class Kind { kBox, kSphere, kCylinder };
  std::string name;  ///< As in the URDF, e.g. "pad"; may be empty.
  Kind kind = Kind::kBox;
  /// Box: full extents. Sphere: radius in x. Cylinder: radius in x, length (along its z axis) in z.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  Eigen::Isometry3d X_LS = Eigen::Isometry3d::Identity();  ///< Pose of the shape in the link.

  /// Distance (m) from a point given in the link's frame to the surface; negative inside.
  double Distance(const Eigen::Vector3d& p_L) const;
};

struct VisualMesh {
  TriMesh mesh;
  Eigen::Vector3f colour = Eigen::Vector3f::Constant(0.7f);  ///< sRGB, 0..1.
  Eigen::Isometry3d X_LV = Eigen::Isometry3d::Identity();    ///< Pose of the mesh in the link.
};

struct RobotLink {
  std::string name;
  double mass_kg = 0;
  Eigen::Vector3d com_L = Eigen::Vector3d::Zero();      ///< Centre of mass, link frame.
  Eigen::Matrix3d inertia_L = Eigen::Matrix3d::Zero();  ///< About the centre of mass, link axes.
  std::vector<VisualMesh> visuals;
  std::vector<CollisionShape> collisions;
};

struct RobotJoint {
  enum class Kind { kFixed, kRevolute, kPrismatic };
  std::string name;
  Kind kind = Kind::kFixed;
  int parent = -1;                                         ///< Link index.
  int child = -1;                                          ///< Link index; greater than parent.
  Eigen::Isometry3d X_PJ = Eigen::Isometry3d::Identity();  ///< Joint frame in the parent at zero.
  Eigen::Vector3d axis_J = Eigen::Vector3d::UnitZ();       ///< Unit length.
  double lower = 0;     ///< rad or m; -inf for a continuous joint.
  double upper = 0;     ///< rad or m; +inf for a continuous joint.
  double velocity = 0;  ///< rad/s or m/s.
  double effort = 0;    ///< N m or N.

  /// Pose of the child in the parent at joint value q.
  Eigen::Isometry3d Transform(double q) const;
};

/// A robot as its URDF describes it: a tree of links. Links are numbered depth first, so that a
/// parent comes before its children; joint i is the one that carries link i + 1.
class RobotModel {
 public:
  /// @param with_visuals  false leaves the visuals out (and does not open their files). Mesh paths:
  ///   `package://NAME/...` is looked up in the nearest folder called NAME that holds the URDF,
  ///   others are relative to the URDF's folder. A collision mesh becomes its bounding box.
  /// @throws InputError, one line with file and element, for anything missing, unknown, non-finite
  ///   or physically meaningless.
  static RobotModel Load(const std::filesystem::path& urdf, bool with_visuals = true);

  const std::vector<RobotLink>& links() const { return links_; }
  const std::vector<RobotJoint>& joints() const { return joints_; }
  std::optional<int> FindLink(std::string_view name) const;
  std::optional<int> FindJoint(std::string_view name) const;
  const std::string& file() const { return file_; }  ///< Where it came from, for messages.

 private:
  RobotModel() = default;
  std::string file_;
  std::vector<RobotLink> links_;
  std::vector<RobotJoint> joints_;
};

}  // namespace gusset
