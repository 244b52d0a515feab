#include "tools/gusset/sim_referee.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "perception/opening_area.h"
#include "perception/state.h"

namespace gusset {
namespace {

cv::Mat PaintSurface(const TopView& view, cv::Size size) {
  cv::Mat surface(size, CV_8UC3);
  for (int at = 0; at < size.area(); ++at) {
    const auto k = static_cast<std::size_t>(at);
    surface.at<cv::Vec3b>(at / size.width, at % size.width) = {
        static_cast<uchar>(view.shown[k]), cv::saturate_cast<uchar>(view.rim_m[k] / kRimStep_m),
        static_cast<uchar>(view.label[k] >= 0 ? 255 : 0)};
  }
  return surface;
}

/// Areas are counted at so many points per pixel and direction, the middle one its centre: a label
/// of which a sliver shows is one or two pixels off by centres alone, and each label counts for
/// hundreds of px^2 of A_o.
constexpr int kFiner = 3;
static_assert(kFiner % 2 == 1);
constexpr double kFiner2 = kFiner * kFiner;

/// The camera with kFiner x kFiner pixels in place of each.
CameraModel Finer(CameraModel camera) {
  Pinhole& pinhole = camera.pinhole;
  pinhole.fx *= kFiner;
  pinhole.fy *= kFiner;
  pinhole.cx = kFiner * pinhole.cx + kFiner / 2;
  pinhole.cy = kFiner * pinhole.cy + kFiner / 2;
  pinhole.width *= kFiner;
  pinhole.height *= kFiner;
  return camera;
}

// What the labels show in `part` of the frame, of which `finer` is the finer view.
void MeasureLabels(const TopView& finer, const cv::Rect& part, FrameTruth& frame) {
  const cv::Point2d middle(kFiner / 2, kFiner / 2);
  for (std::size_t k = 0; k < finer.label_px.size(); ++k) {
    frame.label_px2.push_back(finer.label_px[k] / kFiner2);
    const cv::Point2d centre(finer.label_centre_px[k].x(), finer.label_centre_px[k].y());
    frame.label_centre_px.push_back(finer.label_px[k] > 0
                                        ? (centre - middle) / kFiner + cv::Point2d(part.tl())
                                        : cv::Point2d());
  }
}

// Centroids of the labels that show at least min_px2.
std::vector<cv::Point2d> LabelsSeen(const FrameTruth& frame, double min_px2) {
  std::vector<cv::Point2d> seen;
  for (std::size_t k = 0; k < frame.label_px2.size(); ++k) {
    if (frame.label_px2[k] >= min_px2) seen.push_back(frame.label_centre_px[k]);
  }
  return seen;
}

}  // namespace

int SimReferee::LayersHeld() {
  std::set<int> layers;
  for (const HeldPoint& held : scene_.world().cloth().state().held) layers.insert(held.layer);
  return static_cast<int>(layers.size());
}

FrameTruth SimReferee::Describe() {
  const World& world = scene_.world();
  FrameTruth frame;
  Truth& truth = frame.truth;
  truth.layers_held = LayersHeld();
  truth.bag_held = world.cloth().holding();
  truth.cube_held = world.cube_held();
  const Eigen::Isometry3d& X_WCube = world.cube().X_WB;
  frame.cube_m = X_WCube.translation();
  truth.cube_in_bag = world.InsideBag(frame.cube_m);
  truth.lowest_point_m = world.LowestPoint();
  truth.held_clear_s = world.held_clear_s();

  const Pinhole& pinhole = scene_.model().pinhole;
  TriMesh cube = BoxMesh(Eigen::Vector3d::Constant(scene_.config().world.cube_side_m));
  for (Eigen::Vector3f& p : cube.vertices) p = (X_WCube * p.cast<double>()).cast<float>();
  const ClothItem cloth = scene_.DrawnCloth();
  if (!drawn_ || !drawn_->Fits(cloth)) drawn_.emplace(cloth);
  drawn_->Update(cloth);
  const TopView view = LookAtBag(*drawn_, scene_.labels(), scene_.model(),
                                 {0, 0, pinhole.width, pinhole.height}, &cube);
  const cv::Rect roi(perception_.roi_x, perception_.roi_y, perception_.roi_side,
                     perception_.roi_side);
  const cv::Size size(pinhole.width, pinhole.height);
  frame.surface = PaintSurface(view, size);
  frame.cube_px = view.cube_px;

  const cv::Mat bag(size, CV_8UC1, const_cast<unsigned char*>(view.mask.data()));
  cv::Rect around = cv::boundingRect(bag);
  around = cv::Rect(around.tl() - cv::Point(1, 1), around.br() + cv::Point(1, 1)) & roi;
  const TopView finer = LookAtBag(
      *drawn_, scene_.labels(), Finer(scene_.model()),
      {kFiner * around.x, kFiner * around.y, kFiner * around.width, kFiner * around.height}, &cube);
  MeasureLabels(finer, around, frame);
  const std::vector<cv::Point2d> labels = LabelsSeen(frame, perception_.label_min_px2);
  frame.labels_seen = static_cast<int>(labels.size());
  truth.bag_area_px2 = finer.bag_px / kFiner2;
  truth.opening_area_px2 = MeasureOpening(labels).area_px2;

  Evidence evidence;
  evidence.has_surroundings = true;
  evidence.bag_seen = truth.bag_area_px2 >= perception_.bag_min_px2;
  evidence.labels_seen = frame.labels_seen;
  evidence.A_bag = truth.bag_area_px2;
  evidence.A_o = truth.opening_area_px2;
  evidence.cube_seen = view.cube_px >= perception_.cube_min_px2;
  const cv::Point2d px = scene_.model().Project(frame.cube_m);
  const cv::Point nearest(cvRound(px.x), cvRound(px.y));
  evidence.cube_in_roi = evidence.cube_seen && roi.contains(nearest);
  evidence.cube_on_bag = evidence.cube_in_roi && bag.at<uchar>(nearest) != 0;
  if (evidence.cube_in_roi && frame.labels_seen >= kLabelsOfMouth) {
    std::vector<cv::Point2f> points(labels.begin(), labels.end()), hull;
    cv::convexHull(points, hull);
    const double side_px =
        perception_.cube_side_m * pinhole.fx / scene_.model().X_WC.translation().z();
    evidence.cube_in_mouth = cv::pointPolygonTest(hull, cv::Point2f(px), true) >= -side_px;
  }
  const Classified classified = ClassifyState(evidence, thresholds_);
  truth.state = static_cast<int>(classified.state);
  frame.cube_hidden = classified.cube_hidden;
  return frame;
}

}  // namespace gusset
