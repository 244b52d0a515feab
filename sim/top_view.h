#pragma once

#include <vector>

#include "perception/camera_model.h"
#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/cloth_types.h"

namespace gusset {

/// A printed patch of one layer, in cloth coordinates (m).
struct BagLabel {
  float u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  int layer = 0;
};

/// The labels that a bag's file asks for: evenly spread along both layers' rims.
std::vector<BagLabel> MakeLabels(const BagConfig& bag);

/// What an ideal camera sees of a bag alone: ground truth for labels, starts and tests.
struct TopView {
  int bag_px = 0;             ///< Pixels of the ROI that show the bag.
  std::vector<int> label_px;  ///< Pixels that show each label, in MakeLabels' order.
  std::vector<Eigen::Vector2d> label_centre_px;  ///< Their centroids (where label_px > 0).
  /// Bag pixels as a row-major mask over the ROI, 1 where the bag is.
  std::vector<unsigned char> mask;
};

/// Draws the cloth's triangles with a depth buffer into the ROI (x0, y0, width, height in pixels).
TopView LookAtBag(const ClothMesh& mesh, const Vec3Array& x, const std::vector<BagLabel>& labels,
                  const CameraModel& camera, const std::array<int, 4>& roi);

/// Height of the cloth's uppermost surface above or below the point (x, y), m; -infinity where
/// there is no cloth.
double ClothTopAt(const ClothMesh& mesh, const Vec3Array& x, const Eigen::Vector2d& point);

}  // namespace gusset
