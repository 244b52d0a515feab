#pragma once

namespace gusset {

/// Ground truth about the scene now. For evaluation, labels and logs; never for perception, agents
/// or primitives.
struct Truth {
  int layers_held = 0;        ///< Distinct cloth layers between the pads: 0, 1 or 2.
  bool bag_held = false;      ///< The gripper holds cloth.
  bool cube_held = false;     ///< The gripper holds the cube itself.
  bool cube_in_bag = false;   ///< The cube's centre lies between the layers, inside the seams.
  double lowest_point_m = 0;  ///< Lowest point of bag and cube above the table.
  double held_clear_s =
      0;  ///< Time for which cube-in-bag, held and >= 0.15 m have held without break.
  double bag_area_px2 = 0;      ///< Projected silhouette inside the ROI, from the mesh.
  double opening_area_px2 = 0;  ///< Algorithm 7 over the labels' true, visible centres.
  int state = 0;                ///< State 0..5 by the same table from noise-free truth; -1: lost.
};

class Referee {
 public:
  virtual ~Referee() = default;
  virtual Truth Judge() = 0;
  /// Truth::layers_held alone, which is cheap to tell.
  virtual int LayersHeld() = 0;
};

}  // namespace gusset
