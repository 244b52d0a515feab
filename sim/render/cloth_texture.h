#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "sim/render/scene_view.h"

namespace gusset {

/// The look of one layer, both sides: plain weave, hem under the rim, stitching along the seams,
/// folds that ironing left, labels with soft edges and worn print. CV_8UC3, RGB. Column 0 starts at
/// u = 0, row 0 at v = 0; the last ends at `extent_m`, the layer's size (u, v) in metres.
cv::Mat ClothTexture(const ClothItem& cloth, int layer, const Eigen::Vector2f& extent_m,
                     cv::Size pixels);

/// Mottling as of woven stuff that lay folded, threads along the rows and columns: CV_32FC1, mean
/// about 0, within -1.5..1.5. `side_m` long and wide.
cv::Mat FabricTexture(int pixels, float side_m, std::uint64_t seed);

}  // namespace gusset
