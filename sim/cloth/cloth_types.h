#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "base/config.h"

namespace gusset {

using Vec3f = Eigen::Vector3f;
using Vec3Array = std::vector<Vec3f>;

/// Numbers of the cloth solver that belong to no bag. Section [solver] of the config.
struct ClothSolverConfig {
  int substeps_per_s = 600;
  int iterations = 2;                     ///< Gauss-Seidel sweeps per substep.
  double stretch_compliance_m_N = 1e-7;   ///< Along the yarns, in tension.
  double shear_compliance_m_N = 0.1;      ///< Between the yarns.
  double compression_compliance_m_N = 1;  ///< Cloth buckles below the mesh's resolution.
  double bend_damping_s = 0.002;          ///< Stiffness-proportional damping of bending.
  double damping_per_s = 0.3;             ///< Mass-proportional damping of all motion.
  double separation_speed_m_s = 0.05;  ///< At which contact undoes what is closer than a thickness.
  double max_speed_m_s = 20.0;         ///< A node faster than this stops the world.

  template <class V>
  void Fields(V& v) {
    v("substeps_per_s", substeps_per_s, Range{200, 10000});
    v("iterations", iterations, Range{1, 50});
    v("stretch_compliance_m_N", stretch_compliance_m_N, Range{0, 1e-3});
    v("shear_compliance_m_N", shear_compliance_m_N, Range{1e-6, 10});
    v("compression_compliance_m_N", compression_compliance_m_N, Range{1e-6, 100});
    v("bend_damping_s", bend_damping_s, Range{0, 0.01});
    v("damping_per_s", damping_per_s, Range{0, 100});
    v("separation_speed_m_s", separation_speed_m_s, Range{0.001, 1});
    v("max_speed_m_s", max_speed_m_s, Range{1, 1000});
  }
};

}  // namespace gusset
