#include "agents/look_files.h"

#include "agents/image_file.h"
#include "perception/color_masks.h"
#include "perception/overlay.h"
#include "perception/view.h"

namespace gusset {
namespace {

cv::Mat PaintMasks(const Look& look, const CameraModel& camera, const PerceptionConfig& config) {
  const View view = MakeView(look.frame, camera, config);
  const ColorMasks masks = ThresholdColors(view, config);
  cv::Mat image(view.frame.color.size(), CV_8UC3, cv::Scalar::all(0));
  image(view.roi).setTo(cv::Scalar(255, 0, 0), masks.cloth);
  image(view.roi).setTo(cv::Scalar(0, 255, 0), masks.label);
  image.setTo(cv::Scalar(0, 0, 255), masks.cube);
  return image;
}

}  // namespace

nlohmann::ordered_json WriteLook(const std::string& stem, const Look& look,
                                 const CameraModel& camera, const PerceptionConfig& config) {
  WriteImage(stem + ".png", look.frame.color);
  if (!look.frame.depth_mm.empty()) WriteImage(stem + "_depth.png", look.frame.depth_mm);
  WriteImage(stem + "_overlay.png", DrawOverlay(look.frame, look.seen));
  WriteImage(stem + "_masks.png", PaintMasks(look, camera, config));

  nlohmann::ordered_json labels = nlohmann::ordered_json::array();
  for (const cv::Point2d& label : look.seen.labels) labels.push_back({label.x, label.y});
  nlohmann::ordered_json cube;
  if (look.seen.cube) cube = {look.seen.cube->px.x, look.seen.cube->px.y};
  return {{"state", static_cast<int>(look.seen.state)},
          {"state_true", look.truth.state},
          {"A_bag", look.seen.A_bag},
          {"A_bag_true", look.truth.bag_area_px2},
          {"A_o", look.seen.A_o},
          {"A_o_true", look.truth.opening_area_px2},
          {"labels_px", labels},
          {"cube_px", cube},
          {"warnings", look.seen.warnings}};
}

}  // namespace gusset
