#pragma once

#include <Eigen/Core>

namespace gusset {

/// The block that the arm stands on: to be drawn, and for bag and cube to stop at. World, metres.
struct Pedestal {
  Eigen::Vector3d size_m = {0.25, 0.25, 0.40};
  Eigen::Vector3d centre_m = {0, -0.44, 0.20};
};

}  // namespace gusset
