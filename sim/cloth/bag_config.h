#pragma once

#include <string>
#include <vector>

#include "base/config.h"

namespace gusset {

/// A bag's cut and cloth, as its TOML file gives them. Bounds are those of docs/physics.md.
struct BagConfig {
  std::string name = "bag1";
  std::string material = "cotton";
  double opening_m = 0.30;      ///< Width of the mouth, across the bag (Table 5.3).
  double depth_m = 0.35;        ///< From rim to bottom seam (Table 5.3, "width").
  double thickness_m = 0.0015;  ///< One ply; used by contact, grasp and rendering alike.
  double area_density_kg_m2 = 0.24;
  double flexural_rigidity_Nm = 2e-4;
  /// Curvature that internal friction alone can hold: HB/B of the KES-FB2 bending test, 1/m. Woven
  /// cloth has tens; tuned (docs/physics.md).
  double residual_curvature_1_m = 15;
  /// Half the hysteresis of shearing, per metre of width: HG of the KES-FB1 test. Tuned
  /// (docs/physics.md).
  double shear_hysteresis_N_m = 0.3;
  double friction_cloth = 0.5;    ///< Cloth on cloth.
  double friction_table = 0.6;    ///< Cloth on the canvas.
  double friction_cube = 0.5;     ///< Cloth on the cube.
  double drag_coefficient = 1.3;  ///< Of a flat plate across the flow.
  int labels_per_layer = 5;
  double label_width_m = 0.012;   ///< Along the rim.
  double label_height_m = 0.014;  ///< From the rim towards the bottom.
  std::vector<double> colour_rgb = {0.93, 0.91, 0.85};
  int nodes_across = 16;  ///< Mesh nodes along the mouth, per layer.
  int nodes_deep = 18;    ///< Mesh nodes from rim to bottom, per layer.

  template <class V>
  void Fields(V& v) {
    v("name", name, std::vector<std::string>{});
    v("material", material, std::vector<std::string>{});
    v("opening_m", opening_m, Range{0.10, 1.0});
    v("depth_m", depth_m, Range{0.10, 1.0});
    v("thickness_m", thickness_m, Range{2e-4, 1.5e-3});
    v("area_density_kg_m2", area_density_kg_m2, Range{0.02, 0.35});
    v("flexural_rigidity_Nm", flexural_rigidity_Nm, Range{1e-7, 2e-4});
    v("residual_curvature_1_m", residual_curvature_1_m, Range{0, 100});
    v("shear_hysteresis_N_m", shear_hysteresis_N_m, Range{0, 5});
    v("friction_cloth", friction_cloth, Range{0.2, 0.8});
    v("friction_table", friction_table, Range{0.2, 0.8});
    v("friction_cube", friction_cube, Range{0.2, 0.8});
    v("drag_coefficient", drag_coefficient, Range{1.0, 2.0});
    v("labels_per_layer", labels_per_layer, Range{3, 20});
    v("label_width_m", label_width_m, Range{0.004, 0.05});
    v("label_height_m", label_height_m, Range{0.004, 0.05});
    v("colour_rgb", colour_rgb, Range{0, 1});
    v("nodes_across", nodes_across, Range{8, 64});
    v("nodes_deep", nodes_deep, Range{8, 64});
  }
};

}  // namespace gusset
