#include "agents/image_file.h"

#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/files.h"

namespace gusset {

void WriteImage(const std::filesystem::path& path, const cv::Mat& image) {
  // cv::imwrite says neither why it failed nor that the disk was full half-way.
  std::vector<unsigned char> bytes;
  if (!cv::imencode(path.extension().string(), image, bytes)) {
    throw RunError(path.string() + ": cannot encode this image");
  }
  WriteFileAtomic(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace gusset
