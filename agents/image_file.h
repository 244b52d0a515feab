#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace gusset {

/// Writes an image in the format that the file name's suffix asks for; equal images give equal
/// files.
/// @throws InputError if the place cannot be written, RunError if writing fails (disk full).
void WriteImage(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace gusset
