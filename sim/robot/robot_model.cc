#include "sim/robot/robot_model.h"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <sstream>

#include "base/config.h"
#include "base/error.h"
#include "base/files.h"
#include "sim/robot/mesh_file.h"

namespace gusset {
namespace {

// urdfdom tells why it refuses a file only through console_bridge, which is global: its words are
// caught here, and one file is parsed at a time.
class ParserErrors : public console_bridge::OutputHandler {
 public:
  ParserErrors() : lock_(Mutex()) { console_bridge::useOutputHandler(this); }
  ~ParserErrors() override { console_bridge::restorePreviousOutputHandler(); }
  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level < console_bridge::CONSOLE_BRIDGE_LOG_ERROR) return;
    if (!text_.empty()) text_ += "; ";
    for (const char c : text) text_ += c == '\n' ? ' ' : c;
  }
  const std::string& text() const { return text_; }

 private:
  static std::mutex& Mutex() {
    static std::mutex mutex;
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
  std::string text_;
};

// A robot is written by hand or by a CAD program. The parser and what follows the tree of links
// need stack for each level, so both are bounded.
constexpr std::size_t kMaxUrdfBytes = 4 << 20;
constexpr int kMostXmlDepth = 100;
constexpr std::size_t kMostLinks = 1000;

void RefuseDeepXml(const std::filesystem::path& urdf, const std::string& xml) {
  constexpr std::size_t kEnd = std::string::npos;
  int depth = 0;
  for (std::size_t i = 0; (i = xml.find('<', i)) != kEnd;) {
    const std::string_view rest = std::string_view(xml).substr(i);
    if (rest.starts_with("<!--") || rest.starts_with("<![CDATA[")) {
      i = xml.find(rest[2] == '-' ? "-->" : "]]>", i);
      if (i == kEnd) return;
      continue;
    }
    // To the tag's end, which is not one within quotes.
    std::size_t end = i + 1;
    while ((end = xml.find_first_of("\"'>", end)) != kEnd && xml[end] != '>') {
      end = xml.find(xml[end], end + 1);
      if (end == kEnd) return;
      ++end;
    }
    if (end == kEnd) return;
    if (rest.starts_with("</")) {
      depth = std::max(0, depth - 1);
    } else if (rest[1] != '!' && rest[1] != '?' && xml[end - 1] != '/') {
      ++depth;
    }
    if (depth > kMostXmlDepth) {
      const auto lines =
          std::count(xml.begin(), xml.begin() + static_cast<std::ptrdiff_t>(i), '\n');
      throw InputError(urdf.string() + ":" + std::to_string(lines + 1) +
                       ": is nested deeper than " + std::to_string(kMostXmlDepth) + " levels");
    }
    i = end;
  }
}

// What a robot beside a table can be. Outside of these bounds numbers overflow, or a motion takes
// hours.
constexpr double kMostSize_m = 100;
constexpr Range kPlace_m = {-kMostSize_m, kMostSize_m};
constexpr Range kSize_m = {1e-6, kMostSize_m};
constexpr Range kMass_kg = {0, 1e4};
constexpr Range kInertia_kg_m2 = {-1e6, 1e6};
constexpr Range kAngle_rad = {-1000, 1000};
constexpr Range kSpeed = {0.01, 1000};  // rad/s or m/s
constexpr Range kEffort = {0.01, 1e6};  // N m or N

// One element of one file, for messages.
struct Place {
  std::string file;
  std::string element;
  [[noreturn]] void Fail(const std::string& what) const {
    throw InputError(file + ": " + element + ": " + what);
  }
  double Within(double value, Range bounds, const char* key) const {
    if (value >= bounds.lo && value <= bounds.hi) return value;
    std::ostringstream what;
    what << key << " = " << value << " is not within [" << bounds.lo << ", " << bounds.hi << "]";
    Fail(what.str());
  }
  Eigen::Vector3d Vector(const urdf::Vector3& v, Range bounds, const char* key) const {
    return {Within(v.x, bounds, key), Within(v.y, bounds, key), Within(v.z, bounds, key)};
  }
  double Size(double value, const char* key) const { return Within(value, kSize_m, key); }
  Eigen::Isometry3d Pose(const urdf::Pose& pose) const {
    const urdf::Rotation& r = pose.rotation;
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.translation() = Vector(pose.position, kPlace_m, "origin xyz");
    const Eigen::Quaterniond rotation(r.w, r.x, r.y, r.z);
    if (!(rotation.norm() > 0.5)) Fail("origin rpy is no rotation");
    X.linear() = rotation.normalized().toRotationMatrix();
    return X;
  }
};

std::filesystem::path ResolveMesh(const std::filesystem::path& urdf, const std::string& name,
                                  const Place& place) {
  constexpr std::string_view kPackage = "package://";
  constexpr std::string_view kFile = "file://";
  const std::filesystem::path folder = std::filesystem::absolute(urdf).parent_path();
  if (name.starts_with(kFile)) return name.substr(kFile.size());
  if (!name.starts_with(kPackage)) return folder / name;
  const std::string rest = name.substr(kPackage.size());
  const std::string package = rest.substr(0, rest.find('/'));
  for (std::filesystem::path p = folder; p.has_relative_path(); p = p.parent_path()) {
    if (p.filename() == package) return p.parent_path() / rest;
  }
  place.Fail(name + ": no folder called '" + package + "' holds the URDF");
}

std::vector<MeshPart> ReadMesh(const std::filesystem::path& urdf, const urdf::Mesh& mesh,
                               const Place& place) {
  const std::filesystem::path file = ResolveMesh(urdf, mesh.filename, place);
  std::vector<MeshPart> parts;
  try {
    parts = LoadMeshFile(file);
  } catch (const InputError& error) {
    place.Fail(error.what());
  }
  const Eigen::Vector3f scale = place.Vector(mesh.scale, {-1e6, 1e6}, "mesh scale").cast<float>();
  if ((scale.array() == 0).any()) place.Fail("mesh scale has a 0");
  Eigen::AlignedBox3f box;
  for (MeshPart& part : parts) {
    for (Eigen::Vector3f& v : part.mesh.vertices) {
      v = v.cwiseProduct(scale);
      box.extend(v);
    }
  }
  const float size_m = box.sizes().maxCoeff();
  if (!(size_m > 0 && size_m <= static_cast<float>(kMostSize_m))) {
    place.Fail(file.string() + ": is " + std::to_string(size_m) +
               " m large with its scale, not within (0, " +
               std::to_string(static_cast<int>(kMostSize_m)) + "]");
  }
  return parts;
}

void AppendVisual(const std::filesystem::path& urdf, const urdf::Visual& visual, const Place& place,
                  RobotLink& link) {
  if (visual.geometry == nullptr) place.Fail("visual without geometry");
  if (visual.geometry->type != urdf::Geometry::MESH) return;  // drawn shapes are meshes
  for (MeshPart& part : ReadMesh(urdf, static_cast<urdf::Mesh&>(*visual.geometry), place)) {
    VisualMesh& out = link.visuals.emplace_back();
    out.mesh = std::move(part.mesh);
    out.X_LV = place.Pose(visual.origin);
    if (visual.material != nullptr) {
      const urdf::Color& c = visual.material->color;
      out.colour = Eigen::Vector3f(c.r, c.g, c.b);
    } else if (part.colour) {
      out.colour = *part.colour;
    }
  }
}

CollisionShape ReadCollision(const std::filesystem::path& urdf, const urdf::Collision& collision,
                             const Place& place) {
  if (collision.geometry == nullptr) place.Fail("collision without geometry");
  CollisionShape shape;
  shape.name = collision.name;
  shape.X_LS = place.Pose(collision.origin);
  switch (collision.geometry->type) {
    case urdf::Geometry::BOX: {
      const urdf::Vector3& size = static_cast<urdf::Box&>(*collision.geometry).dim;
      shape.size_m = place.Vector(size, kSize_m, "box size");
      break;
    }
    case urdf::Geometry::SPHERE:
      shape.kind = CollisionShape::Kind::kSphere;
      shape.size_m.x() =
          place.Size(static_cast<urdf::Sphere&>(*collision.geometry).radius, "sphere radius");
      break;
    case urdf::Geometry::CYLINDER: {
      const auto& cylinder = static_cast<urdf::Cylinder&>(*collision.geometry);
      shape.kind = CollisionShape::Kind::kCylinder;
      shape.size_m = {place.Size(cylinder.radius, "cylinder radius"), 0,
                      place.Size(cylinder.length, "cylinder length")};
      break;
    }
    case urdf::Geometry::MESH: {
      Eigen::AlignedBox3d box;
      for (const MeshPart& part :
           ReadMesh(urdf, static_cast<urdf::Mesh&>(*collision.geometry), place)) {
        for (const Eigen::Vector3f& v : part.mesh.vertices) box.extend(v.cast<double>());
      }
      shape.size_m = box.sizes();
      shape.X_LS.translate(box.center());
      break;
    }
  }
  return shape;
}

RobotLink ReadLink(const std::filesystem::path& urdf, const urdf::Link& source, bool with_visuals) {
  const Place place{urdf.string(), "link '" + source.name + "'"};
  RobotLink link;
  link.name = source.name;
  if (source.inertial != nullptr) {
    const urdf::Inertial& inertial = *source.inertial;
    const Eigen::Isometry3d X_LI = place.Pose(inertial.origin);
    link.mass_kg = place.Within(inertial.mass, kMass_kg, "mass");
    link.com_L = X_LI.translation();
    Eigen::Matrix3d inertia;
    inertia << inertial.ixx, inertial.ixy, inertial.ixz,  //
        inertial.ixy, inertial.iyy, inertial.iyz,         //
        inertial.ixz, inertial.iyz, inertial.izz;
    for (const double entry : inertia.reshaped()) {
      (void)place.Within(entry, kInertia_kg_m2, "inertia");
    }
    if (inertia.selfadjointView<Eigen::Upper>().eigenvalues().minCoeff() < 0) {
      place.Fail("inertia is not positive semidefinite");
    }
    link.inertia_L = X_LI.linear() * inertia * X_LI.linear().transpose();
  }
  if (with_visuals) {
    for (const auto& visual : source.visual_array) AppendVisual(urdf, *visual, place, link);
  }
  for (const auto& collision : source.collision_array) {
    link.collisions.push_back(ReadCollision(urdf, *collision, place));
  }
  return link;
}

RobotJoint ReadJoint(const std::filesystem::path& urdf, const urdf::Joint& source) {
  const Place place{urdf.string(), "joint '" + source.name + "'"};
  RobotJoint joint;
  joint.name = source.name;
  joint.X_PJ = place.Pose(source.parent_to_joint_origin_transform);
  if (source.type == urdf::Joint::FIXED) return joint;
  if (source.type != urdf::Joint::REVOLUTE && source.type != urdf::Joint::CONTINUOUS &&
      source.type != urdf::Joint::PRISMATIC) {
    place.Fail("type is none of fixed, revolute, continuous, prismatic");
  }
  joint.kind = source.type == urdf::Joint::PRISMATIC ? RobotJoint::Kind::kPrismatic
                                                     : RobotJoint::Kind::kRevolute;
  joint.axis_J = place.Vector(source.axis, {-1e6, 1e6}, "axis");
  if (joint.axis_J.norm() < 1e-9) place.Fail("axis is zero");
  joint.axis_J.normalize();
  if (source.limits == nullptr) place.Fail("limit is missing");
  joint.velocity = place.Within(source.limits->velocity, kSpeed, "limit velocity");
  joint.effort = place.Within(source.limits->effort, kEffort, "limit effort");
  if (source.type == urdf::Joint::CONTINUOUS) {
    joint.lower = -std::numeric_limits<double>::infinity();
    joint.upper = std::numeric_limits<double>::infinity();
    return joint;
  }
  const Range bounds = source.type == urdf::Joint::PRISMATIC ? kPlace_m : kAngle_rad;
  joint.lower = place.Within(source.limits->lower, bounds, "limit lower");
  joint.upper = place.Within(source.limits->upper, bounds, "limit upper");
  if (!(joint.lower < joint.upper)) {
    place.Fail("limit lower = " + std::to_string(joint.lower) +
               " is not below upper = " + std::to_string(joint.upper));
  }
  return joint;
}

}  // namespace

double CollisionShape::Distance(const Eigen::Vector3d& p_L) const {
  const Eigen::Vector3d p_S = X_LS.inverse() * p_L;
  if (kind == Kind::kSphere) return p_S.norm() - size_m.x();
  // Signed distance outwards along each direction in which the shape ends.
  Eigen::Vector3d d = p_S.cwiseAbs() - 0.5 * size_m;
  if (kind == Kind::kCylinder) {
    d = {std::hypot(p_S.x(), p_S.y()) - size_m.x(), -std::numeric_limits<double>::infinity(),
         d.z()};
  }
  return d.cwiseMax(0.0).norm() + std::min(d.maxCoeff(), 0.0);
}

Eigen::Isometry3d RobotJoint::Transform(double q) const {
  if (kind == Kind::kFixed) return X_PJ;
  Eigen::Isometry3d X = X_PJ;
  if (kind == Kind::kPrismatic) {
    X.translation() += X_PJ.linear() * (q * axis_J);
  } else {
    X.linear() *= Eigen::AngleAxisd(q, axis_J).toRotationMatrix();
  }
  return X;
}

RobotModel RobotModel::Load(const std::filesystem::path& urdf, bool with_visuals) {
  const std::string xml = ReadFile(urdf, kMaxUrdfBytes);
  RefuseDeepXml(urdf, xml);
  urdf::ModelInterfaceSharedPtr tree;
  {
    ParserErrors errors;
    tree = urdf::parseURDF(xml);
    if (tree == nullptr || !errors.text().empty()) {
      throw InputError(urdf.string() + ": not a valid URDF: " + errors.text());
    }
  }
  if (tree->links_.size() > kMostLinks) {
    throw InputError(urdf.string() + ": has " + std::to_string(tree->links_.size()) +
                     " links, more than " + std::to_string(kMostLinks));
  }
  RobotModel model;
  model.file_ = urdf.string();
  const auto append = [&](const auto& self, const urdf::Link& link, int parent) -> void {
    const int index = static_cast<int>(model.links_.size());
    model.links_.push_back(ReadLink(urdf, link, with_visuals));
    if (link.parent_joint != nullptr) {
      RobotJoint& joint = model.joints_.emplace_back(ReadJoint(urdf, *link.parent_joint));
      joint.parent = parent;
      joint.child = index;
    }
    for (const auto& child : link.child_links) self(self, *child, index);
  };
  append(append, *tree->getRoot(), -1);
  return model;
}

std::optional<int> RobotModel::FindLink(std::string_view name) const {
  const auto it = std::ranges::find(links_, name, &RobotLink::name);
  if (it == links_.end()) return std::nullopt;
  return static_cast<int>(it - links_.begin());
}

std::optional<int> RobotModel::FindJoint(std::string_view name) const {
  const auto it = std::ranges::find(joints_, name, &RobotJoint::name);
  if (it == joints_.end()) return std::nullopt;
  return static_cast<int>(it - joints_.begin());
}

}  // namespace gusset
