#include "tools/gusset/image_input.h"

#include <opencv2/imgcodecs.hpp>
#include <string>

#include "agents/image_file.h"
#include "base/error.h"

namespace gusset {

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
