#include "perception/overlay.h"

#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>

#include "base/error.h"
#include "perception/pose_points.h"
#include "perception/view.h"

namespace gusset {
namespace {

const cv::Scalar kGreen(0, 255, 0);
const cv::Scalar kCyan(255, 255, 0);
const cv::Scalar kRed(0, 0, 255);
const cv::Scalar kBlue(255, 0, 0);
const cv::Scalar kBlack(0, 0, 0);
const cv::Scalar kWhite(255, 255, 255);

/// Draws in the region of interest what is given in the frame's pixels.
class Pen {
 public:
  Pen(cv::Mat& image, cv::Point origin) : image_(image), origin_(origin) {}

  void Line(cv::Point2d from, cv::Point2d to, const cv::Scalar& color) {
    cv::line(image_, ToPixel(from), ToPixel(to), color, 2);
  }
  void Dot(cv::Point2d at, const cv::Scalar& color, int radius) {
    cv::circle(image_, ToPixel(at), radius, color, cv::FILLED);
  }
  void Sides(const Quad& quad) {
    for (int k = 0; k < 4; ++k) Line(quad[k], quad[(k + 1) % 4], kGreen);
  }
  /// Lines through a figure at the given shares of its sides, both ways.
  void Grid(const Quad& quad, int count, double first, double step, const cv::Scalar& color) {
    for (int k = 0; k < count; ++k) {
      const double share = first + k * step;
      Line(GridPoint(quad, share, 0), GridPoint(quad, share, 1), color);
      Line(GridPoint(quad, 0, share), GridPoint(quad, 1, share), color);
    }
  }
  void Dots(const std::vector<PosePoint>& points, const cv::Scalar& color, int radius) {
    for (const PosePoint& point : points) Dot(point.px, color, radius);
  }

 private:
  cv::Point ToPixel(cv::Point2d px) const {
    return cv::Point(cvRound(px.x), cvRound(px.y)) - origin_;
  }
  cv::Mat& image_;
  cv::Point origin_;
};

std::string AreaText(double area_px2) {
  if (area_px2 == 0) return "0";
  char text[32];
  std::snprintf(text, sizeof(text), "%.1f", area_px2);
  return text;
}

void DrawText(const Observation& observation, cv::Mat& image) {
  const std::string lines[] = {"Bag area: " + AreaText(observation.A_bag),
                               "Opening area: " + AreaText(observation.A_o),
                               std::string("Piece: ") + (observation.piece ? "True" : "False"),
                               "State: " + std::to_string(static_cast<int>(observation.state))};
  int baseline = image.rows - 64;
  for (const std::string& line : lines) {
    // A dark edge keeps it readable on the cloth.
    const cv::Point at(5, baseline);
    cv::putText(image, line, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, kBlack, 3, cv::LINE_AA);
    cv::putText(image, line, at, cv::FONT_HERSHEY_SIMPLEX, 0.5, kWhite, 1, cv::LINE_AA);
    baseline += 20;
  }
}

void DrawFigures(const Observation& observation, Pen& pen) {
  pen.Sides(observation.corners);
  switch (observation.state) {
    case State::kFolded:
      pen.Grid(observation.corners, 2, 1. / 3, 1. / 3, kGreen);
      pen.Grid(observation.corners, 3, 1. / 6, 1. / 3, kCyan);
      pen.Dots(observation.grasp_points, kRed, 4);
      pen.Dots(observation.edge_points, kRed, 2);
      break;
    case State::kUnfolded:
      pen.Dots(observation.grasp_points, kRed, 2);
      pen.Dots(observation.place_points, kBlue, 2);
      break;
    case State::kOpen:
      pen.Sides(observation.opening_corners);
      pen.Grid(observation.opening_corners, 3, 1. / 6, 1. / 3, kCyan);
      pen.Dots(observation.place_points, kRed, 4);
      break;
    case State::kFilled:
      pen.Grid(observation.corners, 9, 1. / 18, 1. / 9, kCyan);
      pen.Dots(observation.grasp_points, kRed, 1);
      break;
    case State::kSuccess:
    case State::kFail:
      break;
  }
}

}  // namespace

cv::Mat DrawOverlay(const RgbdFrame& frame, const Observation& observation) {
  const cv::Mat view = ScaleToView(frame.color, observation.roi.width);
  if (view.type() != CV_8UC3 || observation.roi.empty() ||
      (observation.roi & cv::Rect({0, 0}, view.size())) != observation.roi) {
    throw InputError("overlay: the frame is not the one that was observed");
  }
  cv::Mat image = view(observation.roi).clone();
  Pen pen(image, observation.roi.tl());
  if (observation.bag_seen) DrawFigures(observation, pen);
  DrawText(observation, image);
  return image;
}

}  // namespace gusset
