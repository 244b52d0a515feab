#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/cloth_types.h"
#include "sim/cloth/rigid_shape.h"
#include "sim/cloth/simd.h"

namespace gusset {

/// Contact of a cloth with rigid shapes. Nodes, edge midpoints and face centres are tested against
/// the shapes' signed distances, and edges and corners of boxes that have a mass, which fit between
/// those, against triangles. Approach is stopped at once, old overlap undone at the separation
/// speed, with Coulomb friction on the substep's slip; shapes with a mass yield and get the
/// impulses.
class RigidContact {
 public:
  /// @param area_m2 of all layers. `mesh` must outlive this.
  RigidContact(const ClothMesh& mesh, float area_m2, float separation_speed_m_s);

  /// Forgets what is near; the next Find looks anew.
  void Invalidate();
  /// Finds what may touch which shape, every few substeps. @returns whether it did.
  bool Find(const Vec4Array& x, const std::vector<RigidShape>& shapes);
  /// Whether any cloth may touch a kinematic shape.
  bool IsNearKinematic(const std::vector<RigidShape>& shapes) const;
  /// Sets true for nodes of samples that may touch any shape.
  void MarkNear(std::vector<bool>& nodes) const;
  /// One Gauss-Seidel pass in a substep of h seconds that began at x_prev.
  void Solve(const Vec4Array& x_prev, const std::vector<float>& inv_mass, float h,
             std::vector<RigidShape>& shapes, Vec4Array& x);
  /// The same for shapes that have a mass alone.
  void SolveYielding(const Vec4Array& x_prev, const std::vector<float>& inv_mass, float h,
                     std::vector<RigidShape>& shapes, Vec4Array& x);
  /// After the substep, with the velocities v that came of it: cloth that was pushed away from a
  /// yielding shape because it was closer than it may be loses the speed of that, or nodes beside a
  /// hanging cube would be thrown to and fro by it and by their yarns for ever.
  void EndSubstep(const std::vector<float>& inv_mass, float h, Vec4Array& v);
  /// What contact could not push out of kinematic shapes: sets their squeeze.
  /// @param held whether the gripper, whose parts they are, holds cloth: then what is squeezed
  ///   between its own parts counts for the pads alone.
  void MeasureSqueeze(const Vec4Array& x, bool held, std::vector<RigidShape>& shapes);

 private:
  struct Sample {             ///< A point of the cloth that shapes are tested against.
    std::array<int, 3> node;  ///< Past `count`: the last again.
    std::array<float, 3> weight;
    int count;
    Vec3f At(const Vec4Array& x) const;
    float InvMass(const std::vector<float>& inv_mass) const;  ///< Of its nodes' means.
  };
  struct Substep {
    const Vec4Array& x_prev;
    const std::vector<float>& inv_mass;
    float h;
  };

  /// Of a point of the cloth and a shape that are too close.
  struct Overlap {
    Vec3f normal;                         ///< Away from the shape.
    float distance_m, distance_before_m;  ///< Now and at the substep's start.
    Vec3f p_S_before;  ///< The point at the substep's start, in the shape's frame.
  };
  /// A point of the cloth that a box's edge or corner is nearest to or deepest beyond.
  struct EdgeContact {
    Sample at;
    Vec3f q_S, normal_S;  ///< The box's point; away from the box.
    float distance_m;     ///< Negative: the point is beyond the triangle's plane.
  };

  /// Cloth that a kinematic shape presses down, and how hard.
  struct Pressing {
    RigidShape* shape;
    Vec3f p;
    Vec3f force;  ///< On the shape, N.
  };

  /// Cloth that was too close to a yielding shape when the substep began, and was pushed away.
  struct Pushed {
    Sample at;
    RigidShape* shape;
    Vec3f normal, arm;  ///< Away from the shape; from its centre.
  };

  void Solve(const Substep& substep, std::size_t shape, std::vector<RigidShape>& shapes,
             Vec4Array& x);
  void PushOut(const Substep& substep, const Sample& m, const Overlap& overlap, RigidShape& shape,
               Vec4Array& x);
  std::optional<EdgeContact> FindEdge(const RigidShape& box, int triangle,
                                      const Vec4Array& x) const;
  void SolveEdges(const Substep& substep, const std::vector<int>& triangles, RigidShape& box,
                  Vec4Array& x);
  void SolveSamples(const Substep& substep, const std::vector<int>& candidates, RigidShape& shape,
                    Vec4Array& x);
  bool BorneByTable(const Vec3Array& beneath, const Vec3f& p) const;
  Vec3Array SamplesBeneath(const std::vector<Pressing>& pressing, const Vec4Array& x);
  void MarkBeyond(const Vec3f& lo, const Vec3f& hi, const Vec4Array& x);

  const ClothMesh& mesh_;
  float gap_m_;  ///< Between the cloth's mid-plane and a shape.
  float separation_speed_m_s_;
  std::vector<Sample> samples_;
  float sample_area_m2_;
  std::vector<std::vector<int>> near_samples_;    ///< Per shape: samples that may touch it.
  std::vector<std::vector<int>> near_triangles_;  ///< Per shape, if it is a box with a mass.
  std::vector<std::uint8_t> beyond_;              ///< Per node: sides of a box that it is beyond.
  int since_find_ = 0;
  std::vector<Pushed> pushed_;  ///< In the substep under way.
};

}  // namespace gusset
