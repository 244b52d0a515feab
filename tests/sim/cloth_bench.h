#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/cloth/cloth.h"

namespace gusset {

inline constexpr float kG = 9.81f;  ///< Cloth's default gravity, m/s^2.

/// A cloth above the middle of the table, and the tool that may hold it.
class Bench {
 public:
  explicit Bench(bool two_layers, BagConfig bag = {}, ClothSolverConfig solver = {},
                 float height_m = 0.003f)
      : Bench(two_layers ? MakeBagMesh(bag) : MakeSheetMesh(bag), bag, solver, height_m) {}
  Bench(ClothMesh mesh, const BagConfig& bag, const ClothSolverConfig& solver, float height_m)
      : h(1.0f / static_cast<float>(solver.substeps_per_s)), cloth(std::move(mesh), bag, solver) {
    ClothState state = cloth.state();
    for (Vec3f& p : state.x) {
      p += Vec3f(-0.5f * static_cast<float>(bag.opening_m), -0.5f * static_cast<float>(bag.depth_m),
                 height_m);
    }
    cloth.SetState(state);
    X_WT.linear() = Vec3f(1, -1, -1).asDiagonal();
  }
  void Run(double seconds, const Vec3f& tool_velocity = Vec3f::Zero()) {
    for (int i = 0; i < static_cast<int>(std::lround(seconds / h)); ++i) {
      X_WT.translation() += tool_velocity * h;
      for (RigidShape& s : shapes) s.X_WS_prev = s.X_WS;
      cloth.Predict(h);
      cloth.SolveConstraints(h, X_WT, shapes);
      most_stretch = std::max(most_stretch, cloth.MaxStretch());
    }
  }
  void GrabAt(const Vec3f& p, float limit_N = 20) {
    X_WT.translation() = p;
    PadGap gap;
    gap.X_WT = X_WT;
    gap.opening_m = 0.006f;
    cloth.BeginHold(gap, limit_N);
  }
  int Crossings() const { return CountCrossings(cloth.mesh(), cloth.state().x); }
  float Mass() const {
    float mass = 0;
    for (const float m : cloth.mesh().mass_kg) mass += m;
    return mass;
  }
  float Weight() const { return Mass() * kG; }

  float h;
  Cloth cloth;
  Eigen::Isometry3f X_WT = Eigen::Isometry3f::Identity();
  std::vector<RigidShape> shapes;
  float most_stretch = 0;
};

}  // namespace gusset
