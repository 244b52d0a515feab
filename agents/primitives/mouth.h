#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace gusset {

/// The mouth of a bag as seen: where the middles of its two lips are, m, world.
struct Mouth {
  Eigen::Vector3d near_W;   ///< The lip at the rim.
  Eigen::Vector3d drawn_W;  ///< The lip drawn back onto the body.
  /// The way the rim looks, as a unit vector. Lips that lie nearly on each other do not tell.
  Eigen::Vector3d rim_outward_W = Eigen::Vector3d::Zero();
  /// How wide it is.
  struct Width {
    double radius_m = 0;                     ///< Of the largest disc that finds room in it.
    double length_m = 0;                     ///< From end to end.
    std::array<Eigen::Vector3d, 2> sides_W;  ///< Its lips on either side of its middle.
    bool closed = true;                      ///< False: part of what was measured is no mouth.
  };
  std::optional<Width> width = std::nullopt;

  /// From the drawn lip to the near one; horizontal.
  Eigen::Vector3d Apart_W() const {
    return {near_W.x() - drawn_W.x(), near_W.y() - drawn_W.y(), 0};
  }
  /// The way the mouth looks, as a unit vector; zero if the lips are not apart.
  Eigen::Vector3d Outward_W() const { return Apart_W().normalized(); }
};

}  // namespace gusset
