#include "tools/gusset/image_input.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <string_view>

#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

constexpr std::size_t kMaxImageBytes = std::size_t{256} << 20;

// True if a PNG or JPEG ends before its last chunk or marker. libpng and libjpeg fill what is
// missing with grey, which is a bag like any other.
bool IsCutOff(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG")) return bytes.find("IEND") == std::string_view::npos;
  if (!bytes.starts_with("\xff\xd8")) return false;
  // Segments (ITU-T T.81, B.1.1.4) up to the first scan; one may hold a whole image, as a preview.
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[i]); };
  std::size_t at = 2;
  while (at + 4 <= bytes.size() && byte(at) == 0xff && byte(at + 1) != 0xda) {
    at += byte(at + 1) == 0xff ? 1 : 2 + (std::size_t{byte(at + 2)} << 8 | byte(at + 3));
  }
  return bytes.find("\xff\xd9", std::min(at, bytes.size())) == std::string_view::npos;
}

}  // namespace

cv::Mat ReadImage(const std::filesystem::path& file, int flags) {
  const std::string bytes = ReadFile(file, kMaxImageBytes);
  cv::Mat image;
  if (IsCutOff(bytes)) throw InputError(file.string() + ": is cut off: the image has no end");
  if (!bytes.empty()) {
    try {
      image = cv::imdecode(
          cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data())),
          flags);
    } catch (const cv::Exception&) {  // what is wrong with it does not matter to the user
    }
  }
  if (image.empty()) throw InputError(file.string() + ": is not an image that can be read");
  return image;
}

RgbdFrame ReadFrame(const std::filesystem::path& color, const std::filesystem::path& depth) {
  RgbdFrame frame;
  frame.color = ReadImage(color, cv::IMREAD_COLOR);
  if (depth.empty()) return frame;
  frame.depth_mm = ReadImage(depth, cv::IMREAD_UNCHANGED);
  if (frame.depth_mm.type() != CV_16UC1) {
    throw InputError(depth.string() + ": is " + cv::typeToString(frame.depth_mm.type()) +
                     ", a depth image must be 16-bit with one channel (mm)");
  }
  if (frame.depth_mm.size() != frame.color.size()) {
    const auto text = [](const cv::Mat& image) {
      return std::to_string(image.cols) + "x" + std::to_string(image.rows);
    };
    throw InputError(depth.string() + ": is " + text(frame.depth_mm) + ", but " + color.string() +
                     " is " + text(frame.color));
  }
  return frame;
}

}  // namespace gusset
