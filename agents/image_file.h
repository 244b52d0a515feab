#pragma once

#include <filesystem>
#include <opencv2/core.hpp>

namespace gusset {

/// Reads an image; flags as cv::imread's. Not while another thread writes to stderr, which is held
/// back meanwhile: decoders complain there.
/// @throws InputError (`path: why`) if it cannot be read, is no image, is cut off or is damaged.
cv::Mat ReadImage(const std::filesystem::path& file, int flags);

/// Writes an image in the format that the file name's suffix asks for; equal images give equal
/// files.
/// @throws InputError if the place cannot be written, RunError if writing fails (disk full).
void WriteImage(const std::filesystem::path& path, const cv::Mat& image);

}  // namespace gusset
