#include "tools/gusset/corpus.h"

#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "agents/image_file.h"
#include "agents/json_fields.h"
#include "base/files.h"
#include "tools/gusset/image_input.h"

namespace gusset {
namespace {

constexpr double kMaxArea = 1e7;   // px^2, any image
constexpr double kMaxLength = 10;  // m

State StateField(const nlohmann::json& label) {
  const auto name = JsonField<std::string>(label, "state");
  for (int s = 0; s < 6; ++s) {
    if (StateName(static_cast<State>(s)) == name) return static_cast<State>(s);
  }
  throw InputError("state = " + name + " is not one of s0 to s5");
}

std::vector<double> Numbers(const nlohmann::json& object, const std::string& key, std::size_t count,
                            double bound) {
  const auto list = JsonField<nlohmann::json::array_t>(object, key);
  std::vector<double> numbers;
  for (const nlohmann::json& value : list) {
    if (!value.is_number() || !(std::abs(value.get<double>()) <= bound)) {
      throw InputError(key + " = " + object.at(key).dump() +
                       " has an element that is no number within " + nlohmann::json(bound).dump());
    }
    numbers.push_back(value.get<double>());
  }
  if (numbers.size() != count) {
    throw InputError(key + " = " + object.at(key).dump() + " must have " + std::to_string(count) +
                     " elements");
  }
  return numbers;
}

LabelledFrame ParseLabel(const std::filesystem::path& folder, const std::string& line) {
  const nlohmann::json label = ParseJson(line);
  const auto path = [&](const char* key) {
    return label.contains(key) ? folder / JsonField<std::string>(label, key)
                               : std::filesystem::path();
  };
  LabelledFrame frame;
  frame.file = JsonField<std::string>(label, "file");
  frame.color = folder / frame.file;
  frame.depth = path("depth");
  frame.surface = path("surface");
  frame.state = StateField(label);
  if (label.contains("world")) {
    frame.world = (folder / std::to_string(JsonField<int>(label, "world"))).string();
  }
  if (label.contains("A_bag") && label.contains("A_o") && label.contains("labels")) {
    frame.has_areas = true;
    frame.A_bag = JsonField<double>(label, "A_bag", 0, kMaxArea);
    frame.A_o = JsonField<double>(label, "A_o", 0, kMaxArea);
    frame.labels = JsonField<int>(label, "labels", 0, 1000);
  }
  if (label.contains("label_px2") && label.contains("label_centre_px")) {
    const auto centres = JsonField<nlohmann::json::array_t>(label, "label_centre_px");
    const std::vector<double> areas = Numbers(label, "label_px2", centres.size(), kMaxArea);
    for (std::size_t k = 0; k < areas.size(); ++k) {
      const std::string key = "label_centre_px[" + std::to_string(k) + "]";
      const std::vector<double> px = Numbers({{key, centres[k]}}, key, 2, kMaxArea);
      frame.shown.push_back({areas[k], {px[0], px[1]}});
    }
  }
  if (label.contains("cube_m") &&
      !(label.contains("cube_hidden") && JsonField<bool>(label, "cube_hidden"))) {
    const std::vector<double> p = Numbers(label, "cube_m", 3, kMaxLength);
    frame.cube_m = Eigen::Vector3d(p[0], p[1], p[2]);
  }
  return frame;
}

}  // namespace

std::vector<LabelledFrame> ReadLabels(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "labels.jsonl";
  std::istringstream lines(ReadFile(file));
  std::vector<LabelledFrame> frames;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    try {
      frames.push_back(ParseLabel(folder, line));
    } catch (const std::exception& e) {
      throw InputError(file.string() + ":" + std::to_string(number) + ": " + e.what());
    }
  }
  if (frames.empty()) throw InputError(file.string() + ": holds no label");
  return frames;
}

CameraModel ReadCamera(const std::filesystem::path& file) {
  try {
    const nlohmann::json document = ParseJson(ReadFile(file));
    CameraModel camera;
    camera.pinhole.width = JsonField<int>(document, "width", 1, 100000);
    camera.pinhole.height = JsonField<int>(document, "height", 1, 100000);
    const auto matrix = [&](const std::string& key, std::size_t rows, std::size_t columns,
                            double bound) {
      const auto list = JsonField<nlohmann::json::array_t>(document, key);
      if (list.size() != rows) {
        throw InputError(key + " must have " + std::to_string(rows) + " rows");
      }
      Eigen::MatrixXd m(static_cast<int>(rows), static_cast<int>(columns));
      for (std::size_t r = 0; r < rows; ++r) {
        const std::string name = key + "[" + std::to_string(r) + "]";
        const std::vector<double> row = Numbers({{name, list[r]}}, name, columns, bound);
        for (std::size_t c = 0; c < columns; ++c)
          m(static_cast<int>(r), static_cast<int>(c)) = row[c];
      }
      return m;
    };
    const auto same = [](const Eigen::MatrixXd& row, const Eigen::MatrixXd& wanted,
                         const std::string& name) {
      if (row == wanted) return;
      std::ostringstream text;
      text << wanted.format(
          Eigen::IOFormat(Eigen::StreamPrecision, 0, ", ", "; ", "", "", "[", "]"));
      throw InputError(name + " must be " + text.str());
    };
    const Eigen::MatrixXd k = matrix("K", 3, 3, 1e6);
    if (k(0, 1) != 0) throw InputError("K[0][1] must be 0: pixels with skew are not modelled");
    same(k.row(1).head(1), Eigen::RowVectorXd::Zero(1), "K[1][0]");
    same(k.row(2), Eigen::RowVector3d(0, 0, 1), "K[2]");
    if (!(k(0, 0) >= 1 && k(1, 1) >= 1))
      throw InputError("K[0][0] and K[1][1] must be 1 px or more");
    camera.pinhole.fx = k(0, 0);
    camera.pinhole.fy = k(1, 1);
    camera.pinhole.cx = k(0, 2);
    camera.pinhole.cy = k(1, 2);
    const Eigen::MatrixXd pose = matrix("X_WC", 4, 4, 1e3);
    same(pose.row(3), Eigen::RowVector4d(0, 0, 0, 1), "X_WC[3]");
    camera.X_WC.matrix() = pose;
    // A rotation without shear or reflection, to what printing leaves of it.
    const Eigen::Matrix3d R = camera.X_WC.linear();
    if (!(R * R.transpose()).isIdentity(1e-6) || R.determinant() < 0) {
      throw InputError("X_WC is not a pose: its 3x3 part is no rotation");
    }
    return camera;
  } catch (const InputError& e) {
    const std::string what = e.what();
    throw InputError(what.starts_with(file.string()) ? what : file.string() + ": " + what);
  } catch (const nlohmann::json::exception& e) {
    throw InputError(file.string() + ": " + e.what());
  }
}

cv::Mat ReadSurface(const std::filesystem::path& file, cv::Size size) {
  cv::Mat surface = ReadImage(file, cv::IMREAD_UNCHANGED);
  if (surface.type() != CV_8UC3 || surface.size() != size) {
    throw InputError(file.string() + ": must be an 8-bit image with three channels, " +
                     std::to_string(size.width) + "x" + std::to_string(size.height));
  }
  return surface;
}

}  // namespace gusset
