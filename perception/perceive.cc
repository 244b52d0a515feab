#include "perception/perceive.h"

#include <algorithm>
#include <climits>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "perception/bag_body.h"
#include "perception/color_masks.h"
#include "perception/cube.h"
#include "perception/depth.h"
#include "perception/labels.h"
#include "perception/mouth_by_depth.h"
#include "perception/mouth_outline.h"
#include "perception/opening_area.h"
#include "perception/outline.h"
#include "perception/pose_points.h"
#include "perception/rim.h"
#include "perception/shapes.h"
#include "perception/view.h"

namespace gusset {
namespace {

/// Griding parameters (thesis, section 5.3.1).
constexpr int kZeta = 3;
constexpr int kZetaFilled = 9;
constexpr int kRimPoints = 9;

/// Shows `masks` the cube as cloth where it lies amid cloth, so that it does not notch the bag.
cv::Mat ClothWithCube(const ColorMasks& masks, const std::optional<CubeBlob>& cube,
                      const View& view) {
  cv::Mat cloth = masks.cloth | masks.label;
  if (cube && cube->amid_cloth) {
    // A thick border, since the cube's soft edge is neither red nor cream.
    const std::vector<std::vector<cv::Point>> polygon = {cube->contour};
    cv::drawContours(cloth, polygon, 0, 255, cv::FILLED, cv::LINE_8, cv::noArray(), INT_MAX,
                     -view.roi.tl());
    cv::drawContours(cloth, polygon, 0, 255, 3, cv::LINE_8, cv::noArray(), INT_MAX, -view.roi.tl());
  }
  return cloth;
}

std::vector<cv::Point2f> Hull(const std::vector<cv::Point2d>& points) {
  const std::vector<cv::Point2f> floats(points.begin(), points.end());
  std::vector<cv::Point2f> hull;
  cv::convexHull(floats, hull);
  return hull;
}

/// The cloth that shows: the bag less the cube, which lies on or in it.
cv::Mat ShownCloth(const BagBody& bag, const std::optional<CubeBlob>& cube, const View& view) {
  if (!cube) return bag.mask;
  return bag.mask & ~FilledContour(cube->contour, view.roi);
}

/// Points of the mouth's lips: its labels, or what stands for them on a bag without.
std::vector<cv::Point2d> FindMouth(const View& view, const ColorMasks& masks, const BagBody& bag,
                                   int most, const PerceptionConfig& config) {
  std::vector<cv::Point2d> points;
  if (config.mouth == "depth") {
    const cv::Mat depth = view.frame.depth_mm.empty() ? cv::Mat() : view.frame.depth_mm(view.roi);
    points = FindLipPoints(view.frame.color(view.roi), depth, bag.mask, 2 * most, config);
  } else {
    for (const Label& label : FindLabels(masks.label_cover, bag.mask, most, config)) {
      points.push_back(label.centroid);
    }
  }
  for (cv::Point2d& point : points) point += cv::Point2d(view.roi.tl());
  return points;
}

bool IsInMouth(const CubeSeen& cube, const std::vector<cv::Point2d>& labels, double cube_width) {
  if (static_cast<int>(labels.size()) < kLabelsOfMouth) return false;
  return cv::pointPolygonTest(Hull(labels), cv::Point2f(cube.centre_px), /*measureDist=*/true) >=
         -cube_width;
}

bool IsOnBag(const CubeSeen& cube, const std::optional<BagBody>& bag, const View& view) {
  if (!bag || !cube.in_roi) return false;
  const cv::Point centre(cvRound(cube.centre_px.x), cvRound(cube.centre_px.y));
  return bag->mask.at<uchar>(centre - view.roi.tl()) != 0;
}

Eigen::Vector3d Level(const View& view, cv::Point2d from, cv::Point2d to,
                      const PerceptionConfig& config) {
  Eigen::Vector3d offset =
      OntoLevel(view, to, config.table_height_m) - OntoLevel(view, from, config.table_height_m);
  offset.z() = 0;
  return offset.norm() > 0 ? offset.normalized() : Eigen::Vector3d::UnitX();
}

Rim FindRim(const Outline& outline, cv::Point2d outward, const View& view,
            const PerceptionConfig& config) {
  Rim rim;
  rim.outward_px = outward;
  // A step as long as a bag: short ones would be lost in rounding.
  const cv::Point2d step = 100 * outward;
  rim.outward_W = Level(view, outline.centroid, outline.centroid + step, config);
  rim.along_W = {-rim.outward_W.y(), rim.outward_W.x(), 0};
  return rim;
}

// Splits the labels half way between the one nearest the rim and the one farthest from it.
std::optional<Lips> FindLips(const Observation& observation, const View& view,
                             const PerceptionConfig& config) {
  if (!observation.mouth_seen) return std::nullopt;
  const auto depth = [&](const cv::Point2d& px) { return -px.dot(observation.rim->outward_px); };
  const auto [nearest, farthest] = std::ranges::minmax(observation.labels, {}, depth);
  const double half = 0.5 * (depth(nearest) + depth(farthest));
  std::array<cv::Point2d, 2> sum{};
  std::array<int, 2> count{};
  for (const cv::Point2d& label : observation.labels) {
    const int drawn = depth(label) > half ? 1 : 0;
    sum[drawn] += label;
    ++count[drawn];
  }
  if (count[0] == 0 || count[1] == 0) return std::nullopt;
  return Lips{Deproject(view, sum[0] / count[0], config),
              Deproject(view, sum[1] / count[1], config)};
}

std::vector<PosePoint> ToPosePoints(std::vector<cv::Point2d> points, const cv::Mat& cloth,
                                    const View& view, const PerceptionConfig& config) {
  SnapOnto(cloth, view.roi.tl(), config.point_inset_px, points);
  std::vector<PosePoint> poses;
  for (const cv::Point2d& px : points) poses.push_back(Deproject(view, px, config));
  return poses;
}

void AddPosePoints(const BagBody& bag, const std::optional<CubeBlob>& cube, const View& view,
                   const PerceptionConfig& config, Observation& observation) {
  Outline outline = FitOutline(bag.contour);
  const cv::Point2d corner(view.roi.tl());
  outline.centroid += corner;
  outline.middle += corner;
  for (cv::Point2d& point : outline.corners) point += corner;

  const bool from_rim = observation.state != State::kFolded && !observation.labels.empty();
  cv::Point2d outward;
  if (from_rim) {
    outward = RimDirection(bag.mask, observation.labels, view.roi.tl(), config.rim_reach_px);
    outline = outline.From(SideTowards(outline, outward));
    if (observation.state == State::kUnfolded) {
      outline.corners = CornersFromRow(outline, observation.labels, outward, config.label_inset_px);
    }
  } else {
    outline = outline.From(UpperRightCorner(outline));
  }
  observation.corners = outline.corners;
  observation.bag_centroid = outline.centroid;
  if (from_rim) {
    observation.rim = FindRim(outline, outward, view, config);
    observation.lips = FindLips(observation, view, config);
  }

  std::vector<cv::Point2d> grasp;
  std::vector<cv::Point2d> place;
  std::vector<cv::Point2d> edge;
  switch (observation.state) {
    case State::kFolded:
      grasp = CellCentres(outline.corners, kZeta);
      edge = EdgePoints(bag.contour, view.roi.tl(), outline.centroid, grasp,
                        config.edge_cone_deg * std::numbers::pi / 180, config.edge_inset_px,
                        config.edge_central_px);
      break;
    case State::kUnfolded:
      grasp = RimPoints(outline.corners, kRimPoints);
      place = CellCentres(outline.corners, kZeta);
      break;
    case State::kOpen: {
      const Outline mouth = FitOutline(Hull(observation.labels));
      observation.opening_corners = mouth.From(SideTowards(mouth, outline.normals[0])).corners;
      place = CellCentres(observation.opening_corners, kZeta);
      const std::vector<cv::Point2d> lips = MouthOutline(observation.labels);
      const MouthDepth depth = DepthWithin(lips, view.roi);
      if (!depth.part.empty()) {
        SnapOnto(RoomWithin(depth, config.place_inset_px), depth.part.tl(), 0, place);
      }
      if (const auto width = MeasureWidth(lips, depth)) {
        // Without labels, gaps are pieces of hem that were not found.
        const bool closed =
            config.mouth != "labels" ||
            (GoesRound(lips) && ShareOutside(depth, bag.mask, view.roi.tl()) <= kTableShare);
        observation.width = Width{
            width->radius_px,
            width->length_px,
            {Deproject(view, width->sides[0], config), Deproject(view, width->sides[1], config)},
            closed};
      }
      break;
    }
    case State::kFilled:
      grasp = CellCentres(outline.corners, kZetaFilled);
      break;
    case State::kSuccess:
    case State::kFail:
      break;
  }
  const cv::Mat cloth = ShownCloth(bag, cube, view);
  observation.grasp_points = ToPosePoints(std::move(grasp), cloth, view, config);
  observation.place_points = ToPosePoints(std::move(place), cloth, view, config);
  observation.edge_points = ToPosePoints(std::move(edge), cloth, view, config);
}

void AddWarnings(const View& view, const std::optional<BagBody>& bag, Observation& observation) {
  std::vector<std::string>& warnings = observation.warnings;
  if (view.scaled) warnings.push_back("image scaled to the size that thresholds are given for");
  if (!view.has_surroundings) warnings.push_back("bare region of interest: state by areas alone");
  if (view.frame.depth_mm.empty()) warnings.push_back("no depth image: points lie on the table");
  if (bag && bag->at_border) warnings.push_back("bag cut by the edge of the region of interest");
  if (observation.state == State::kFilled && !observation.rim) {
    warnings.push_back("no label seen: points numbered from the upper right");
  }
  const auto without_depth = [](const std::vector<PosePoint>& points) {
    return std::count_if(points.begin(), points.end(),
                         [](const PosePoint& point) { return !point.from_depth; });
  };
  const auto missing = without_depth(observation.grasp_points) +
                       without_depth(observation.place_points) +
                       without_depth(observation.edge_points);
  if (missing > 0 && !view.frame.depth_mm.empty()) {
    warnings.push_back("no depth at " + std::to_string(missing) + " pose points");
  }
}

}  // namespace

Observation Perceive(const RgbdFrame& frame, const CameraModel& camera,
                     const PerceptionConfig& config, const BagThresholds& thresholds) {
  const View view = MakeView(frame, camera, config);
  const ColorMasks masks = ThresholdColors(view, config);
  const std::optional<CubeBlob> blob = FindCube(masks, view, config);
  const std::optional<BagBody> bag = FindBag(ClothWithCube(masks, blob, view), config);

  Observation observation;
  observation.roi = view.roi;
  observation.has_surroundings = view.has_surroundings;
  if (blob) observation.cube = LocateCube(*blob, masks, view, config);
  observation.piece = observation.cube && observation.cube->in_roi;
  if (bag) {
    observation.bag_seen = true;
    observation.bag_at_border = bag->at_border;
    observation.A_bag = bag->area_px2;
    observation.labels = FindMouth(view, masks, *bag, 2 * thresholds.labels_per_layer, config);
    observation.mouth_seen = static_cast<int>(observation.labels.size()) >= kLabelsOfMouth;
    const Opening opening = MeasureOpening(observation.labels);
    observation.A_o = opening.area_px2;
    observation.opening_radius_px = std::sqrt(opening.area_px2 / std::numbers::pi);
    observation.opening_centre = Deproject(view, opening.centre, config);
  }

  Evidence evidence;
  evidence.has_surroundings = view.has_surroundings;
  evidence.bag_seen = observation.bag_seen;
  evidence.cube_seen = observation.cube.has_value();
  evidence.cube_in_roi = observation.piece;
  evidence.cube_in_mouth = observation.piece && IsInMouth(*observation.cube, observation.labels,
                                                          CubeWidth(view, config));
  if (observation.cube) observation.cube->on_bag = IsOnBag(*observation.cube, bag, view);
  evidence.cube_on_bag = observation.cube && observation.cube->on_bag;
  evidence.labels_seen = static_cast<int>(observation.labels.size());
  evidence.A_bag = observation.A_bag;
  evidence.A_o = observation.A_o;
  const Classified classified = ClassifyState(evidence, thresholds);
  observation.state = classified.state;
  observation.cube_hidden = classified.cube_hidden;

  if (bag) AddPosePoints(*bag, blob, view, config, observation);
  AddWarnings(view, bag, observation);
  return observation;
}

}  // namespace gusset
