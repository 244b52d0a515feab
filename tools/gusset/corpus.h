#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "perception/camera_model.h"
#include "perception/state.h"

namespace gusset {

/// One line of labels.jsonl. Paths are whole; those of files that the line does not name are empty.
struct LabelledFrame {
  std::filesystem::path color, depth;
  std::filesystem::path surface;  ///< FrameTruth::surface as an image.
  std::string file;               ///< As the line names it.
  std::string world;              ///< Frames with the same name show the same bag; may be empty.
  State state = State::kSuccess;
  bool has_areas = false;  ///< The next three are given.
  double A_bag = 0;        ///< px^2.
  double A_o = 0;          ///< px^2.
  int labels = 0;          ///< Labels seen.
  /// What shows of each label, if the line says so.
  struct Label {
    double px2 = 0;
    cv::Point2d centre_px;
  };
  std::vector<Label> shown;
  std::optional<Eigen::Vector3d> cube_m;  ///< The cube's centre, where it can be seen.
};

/// Reads the labels of a folder that `gusset render` wrote. Lines written by hand need `file` and
/// `state` alone.
/// @throws InputError naming file, line, key and value.
std::vector<LabelledFrame> ReadLabels(const std::filesystem::path& folder);

/// The camera of camera.json (K, width, height, X_WC). @throws InputError naming file and key.
CameraModel ReadCamera(const std::filesystem::path& file);

/// The image of LabelledFrame::surface. @throws InputError if it is not one, or not of that size.
cv::Mat ReadSurface(const std::filesystem::path& file, cv::Size size);

}  // namespace gusset
