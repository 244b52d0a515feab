#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "perception/rgbd_frame.h"

namespace gusset {

/// Reads an image. @param flags as cv::imread's.
/// @throws InputError (`path: why`) if it cannot be read or is no image.
cv::Mat ReadImage(const std::filesystem::path& file, int flags);

/// A colour image with its depth (an empty path: none). @throws InputError.
RgbdFrame ReadFrame(const std::filesystem::path& color, const std::filesystem::path& depth);

}  // namespace gusset
