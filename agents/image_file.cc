#include "agents/image_file.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <string_view>
#include <vector>

#include "base/captured_stderr.h"
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

// True if libjpeg had to make up a part of the image, as far as its first words tell: it warns of
// bytes too many as well, which some cameras write.
bool SaysDamaged(const std::string& words) {
  return words.find("Corrupt JPEG data") != std::string::npos &&
         words.find("extraneous bytes") == std::string::npos;
}

}  // namespace

cv::Mat ReadImage(const std::filesystem::path& file, int flags) {
  const std::string bytes = ReadFile(file, kMaxImageBytes);
  if (IsCutOff(bytes)) throw InputError(file.string() + ": is cut off: the image has no end");
  cv::Mat image;
  std::string words;
  if (!bytes.empty()) {
    CapturedStderr captured;
    try {
      image = cv::imdecode(
          cv::Mat(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<char*>(bytes.data())),
          flags);
    } catch (const cv::Exception&) {  // what is wrong with it does not matter to the user
    }
    words = captured.Text();
  }
  if (image.empty()) throw InputError(file.string() + ": is not an image that can be read");
  if (SaysDamaged(words)) throw InputError(file.string() + ": is damaged");
  return image;
}

void WriteImage(const std::filesystem::path& path, const cv::Mat& image) {
  // cv::imwrite says neither why it failed nor that the disk was full half-way.
  std::vector<unsigned char> bytes;
  if (!cv::imencode(path.extension().string(), image, bytes)) {
    throw RunError(path.string() + ": cannot encode this image");
  }
  WriteFileAtomic(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace gusset
