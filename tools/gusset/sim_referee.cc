#include "tools/gusset/sim_referee.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "perception/opening_area.h"
#include "perception/state.h"

namespace gusset {

int SimReferee::LayersHeld() {
  std::set<int> layers;
  for (const HeldPoint& held : scene_.world().cloth().state().held) layers.insert(held.layer);
  return static_cast<int>(layers.size());
}

Truth SimReferee::Judge() {
  const World& world = scene_.world();
  const ClothState& cloth = world.cloth().state();
  Truth truth;
  truth.layers_held = LayersHeld();
  truth.bag_held = world.cloth().holding();
  truth.cube_held = world.cube_held();
  const Eigen::Vector3d cube = world.cube().X_WB.translation();
  truth.cube_in_bag = world.InsideBag(cube);
  truth.lowest_point_m = world.LowestPoint();
  truth.held_clear_s = world.held_clear_s();

  const cv::Rect roi(perception_.roi_x, perception_.roi_y, perception_.roi_side,
                     perception_.roi_side);
  const TopView view = LookAtBag(world.cloth().mesh(), cloth.x, scene_.labels(), scene_.model(),
                                 {roi.x, roi.y, roi.width, roi.height});
  std::vector<cv::Point2d> seen;
  for (std::size_t k = 0; k < view.label_px.size(); ++k) {
    if (view.label_px[k] < perception_.label_min_px2) continue;
    seen.emplace_back(view.label_centre_px[k].x(), view.label_centre_px[k].y());
  }
  truth.bag_area_px2 = view.bag_px;
  truth.opening_area_px2 = MeasureOpening(seen).area_px2;

  Evidence evidence;
  evidence.has_surroundings = true;
  evidence.bag_seen = view.bag_px >= perception_.bag_min_px2;
  evidence.labels_seen = static_cast<int>(seen.size());
  evidence.A_bag = truth.bag_area_px2;
  evidence.A_o = truth.opening_area_px2;
  // The cube is seen where no cloth lies above its centre.
  const cv::Point2d px = scene_.model().Project(cube);
  const cv::Point2d in_roi(px.x - roi.x, px.y - roi.y);
  const bool inside =
      in_roi.x >= 0 && in_roi.y >= 0 && in_roi.x < roi.width && in_roi.y < roi.height;
  const bool covered = ClothTopAt(world.cloth().mesh(), cloth.x, cube.head<2>()) > cube.z();
  const bool in_frame = px.x >= 0 && px.y >= 0 && px.x < 640 && px.y < 480 && cube.z() < 0.5;
  evidence.cube_seen = in_frame && !covered;
  evidence.cube_in_roi = evidence.cube_seen && inside;
  evidence.cube_on_bag = evidence.cube_in_roi &&
                         view.mask[static_cast<std::size_t>(std::lround(std::floor(in_roi.y))) *
                                       static_cast<std::size_t>(roi.width) +
                                   static_cast<std::size_t>(in_roi.x)] != 0;
  if (evidence.cube_in_roi && seen.size() >= 3) {
    std::vector<cv::Point2f> points(seen.begin(), seen.end()), hull;
    cv::convexHull(points, hull);
    const double side_px =
        perception_.cube_side_m * scene_.model().pinhole.fx / scene_.model().X_WC.translation().z();
    evidence.cube_in_mouth = cv::pointPolygonTest(hull, cv::Point2f(in_roi), true) >= -side_px;
  }
  truth.state = static_cast<int>(ClassifyState(evidence, thresholds_).state);
  return truth;
}

}  // namespace gusset
