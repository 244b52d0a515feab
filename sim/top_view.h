#pragma once

#include <cstdint>
#include <vector>

#include "perception/camera_model.h"
#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/cloth_types.h"
#include "sim/render/cloth_surface.h"
#include "sim/tri_mesh.h"

namespace gusset {

/// The labels that a bag's file asks for: evenly spread along both layers' rims.
std::vector<LabelPatch> MakeLabels(const BagConfig& bag);

/// What a pixel shows. Inner: the side of a layer that faces the other layer of an empty bag.
enum class Shown : std::uint8_t { kNothing, kOuter0, kOuter1, kInner0, kInner1, kCube };

/// What an ideal camera sees of a bag and the cube: ground truth for labels, starts and tests.
/// A pixel shows what is at its centre.
/// Images are row-major over the region looked at.
struct TopView {
  int bag_px = 0;             ///< Pixels that show the bag, with or without the cube over it.
  int cube_px = 0;            ///< Pixels that show the cube.
  std::vector<int> label_px;  ///< Pixels that show each label, in MakeLabels' order.
  std::vector<Eigen::Vector2d> label_centre_px;  ///< Their centroids (where label_px > 0).
  std::vector<unsigned char> mask;               ///< 1 where the bag is, under the cube too.
  std::vector<Shown> shown;
  std::vector<float> rim_m;         ///< Where cloth is shown: its distance from the rim, in cloth.
  std::vector<std::int16_t> label;  ///< Index of the label shown; -1: none.
};

/// The cloth as the renderer draws it, and the cube if there is one, in the region `roi` (x0, y0,
/// width, height in pixels).
/// @param cloth_W updated to the cloth's shape.
/// @param cube_W closed, world frame.
TopView LookAtBag(const ClothSurface& cloth_W, const std::vector<LabelPatch>& labels,
                  const CameraModel& camera, const std::array<int, 4>& roi,
                  const TriMesh* cube_W = nullptr);

/// The same without the cloth's thickness: for what must not depend on how cloth is drawn.
TopView LookAtBag(const ClothMesh& mesh, const Vec3Array& x, const std::vector<LabelPatch>& labels,
                  const CameraModel& camera, const std::array<int, 4>& roi,
                  const TriMesh* cube_W = nullptr);

}  // namespace gusset
