#include "agents/report/html_page.h"

#include <array>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "agents/image_file.h"
#include "base/config.h"
#include "base/error.h"
#include "base/files.h"

namespace gusset {
namespace {

constexpr const char* kChartJs = "/usr/share/javascript/chart.js/chart.min.js";
constexpr int kJpegQuality = 80;

// JSON in which no "<" is left, so that it can neither end the script that holds it nor begin a
// comment; JSON reads \u003c as the same character. Text that is not UTF-8 gets replacement signs.
std::string DataText(const nlohmann::ordered_json& data) {
  const std::string json = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string text;
  for (const char c : json) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

std::string ChartingLibrary() {
  if (!Exists(kChartJs)) {
    throw InputError(std::string(kChartJs) +
                     ": is missing; install the Debian package libjs-chart.js (tools/setup does)");
  }
  return ReadFile(kChartJs);
}

}  // namespace

std::string FillPage(const std::string& name, const nlohmann::ordered_json& data) {
  const std::filesystem::path folder = AssetsFolder() / "report";
  const std::filesystem::path file = folder / (name + ".html");
  const std::string page = ReadFile(file);
  if (page.find("{{data}}") == std::string::npos) {
    throw InputError(file.string() + ": has no {{data}}");
  }
  std::string filled;
  for (std::size_t at = 0;;) {
    const std::size_t open = page.find("{{", at);
    filled += page.substr(at, open - at);
    if (open == std::string::npos) return filled;
    const std::size_t close = page.find("}}", open);
    if (close == std::string::npos) throw InputError(file.string() + ": {{ without }}");
    const std::string what = page.substr(open + 2, close - open - 2);
    at = close + 2;
    if (what == "data") {
      filled += DataText(data);
    } else if (what == "chart.js") {
      filled += ChartingLibrary();
    } else if (what.starts_with("file ")) {
      filled += ReadFile(folder / what.substr(5));
    } else {
      throw InputError(file.string() + ": {{" + what + "}} stands for nothing");
    }
  }
}

std::string Base64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

std::string DataUri(const std::string& type, std::string_view bytes) {
  return "data:" + type + ";base64," + Base64(bytes);
}

std::string PictureUri(const std::filesystem::path& file, int width_px) {
  cv::Mat image = ReadImage(file, cv::IMREAD_COLOR);
  if (image.cols > width_px) {
    const int height =
        std::max(1, cvRound(static_cast<double>(image.rows) * width_px / image.cols));
    cv::resize(image, image, {width_px, height}, 0, 0, cv::INTER_AREA);
  }
  std::vector<unsigned char> jpeg;
  cv::imencode(".jpg", image, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return DataUri("image/jpeg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
}

}  // namespace gusset
