#pragma once

#include <vector>

#include "base/config.h"

namespace gusset {

/// What is in the world besides bag and arm, and when it counts as at rest.
struct WorldConfig {
  double cube_side_m = 0.035;  ///< Its size in figure 5.2 f.
  double cube_mass_kg = 0.040;
  double cube_friction = 0.5;                     ///< Against table and gripper.
  std::vector<double> cube_wait_m = {0.42, 0.0};  ///< Where it waits, on the table.
  double pad_width_m = 0.022;                     ///< 2F-85 manual: pads of 22 x 37.5 mm.
  double pad_height_m = 0.0375;
  double pad_friction = 0.7;  ///< Rubber on cloth and cube.
  /// The world sleeps until something comes near once, for rest_time_s, the cube has been slower
  /// than this and the cloth's nodes have stayed as near to where they were (root mean square) as
  /// this brings them in that time. 0: never.
  double rest_speed_m_s = 0.003;
  double rest_time_s = 0.15;
  /// Of a link from the cloth's mid-surface; at 1 m/s it moves 1.7 mm in a substep of 1/600 s.
  double wake_distance_m = 0.0025;

  template <class V>
  void Fields(V& v) {
    v("cube_side_m", cube_side_m, Range{0.015, 0.1});
    v("cube_mass_kg", cube_mass_kg, Range{0.002, 1});
    v("cube_friction", cube_friction, Range{0.05, 1.5});
    v("cube_wait_m", cube_wait_m, Range{-0.6, 0.6});
    v("pad_width_m", pad_width_m, Range{0.005, 0.1});
    v("pad_height_m", pad_height_m, Range{0.005, 0.1});
    v("pad_friction", pad_friction, Range{0.05, 1.5});
    v("rest_speed_m_s", rest_speed_m_s, Range{0, 0.1});
    v("rest_time_s", rest_time_s, Range{0.01, 10});
    v("wake_distance_m", wake_distance_m, Range{0, 0.2});
  }
};

}  // namespace gusset
