#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

#include "perception/rgbd_frame.h"

namespace gusset {

/// A colour image with its depth (an empty path: none). @throws InputError.
RgbdFrame ReadFrame(const std::filesystem::path& color, const std::filesystem::path& depth);

}  // namespace gusset
