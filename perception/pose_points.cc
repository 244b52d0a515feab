#include "perception/pose_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "perception/require.h"

namespace gusset {
namespace {

constexpr double kRimShare = 0.5 / 9;

bool Covers(const cv::Mat& mask, cv::Point at) {
  return cv::Rect({0, 0}, mask.size()).contains(at) && mask.at<uchar>(at) != 0;
}

/// The mask less a margin; the image's own edge counts as an edge.
cv::Mat Inside(const cv::Mat& mask, double inset_px) {
  const int size = 2 * static_cast<int>(std::ceil(inset_px)) + 1;
  cv::Mat inside;
  cv::erode(mask, inside, cv::getStructuringElement(cv::MORPH_RECT, {size, size}), {-1, -1}, 1,
            cv::BORDER_CONSTANT, 0);
  return inside;
}

}  // namespace

cv::Point2d GridPoint(const Quad& quad, double along, double away) {
  const cv::Point2d first = quad[0] + along * (quad[1] - quad[0]);
  const cv::Point2d opposite = quad[3] + along * (quad[2] - quad[3]);
  return first + away * (opposite - first);
}

std::vector<cv::Point2d> CellCentres(const Quad& quad, int zeta) {
  std::vector<cv::Point2d> centres;
  for (int row = 0; row < zeta; ++row) {
    for (int column = 0; column < zeta; ++column) {
      centres.push_back(GridPoint(quad, (column + 0.5) / zeta, (row + 0.5) / zeta));
    }
  }
  return centres;
}

std::vector<cv::Point2d> RimPoints(const Quad& quad, int count) {
  std::vector<cv::Point2d> points;
  for (int k = 0; k < count; ++k) points.push_back(GridPoint(quad, (k + 0.5) / count, kRimShare));
  return points;
}

std::vector<cv::Point2d> EdgePoints(const std::vector<cv::Point>& contour, cv::Point origin,
                                    cv::Point2d centre, const std::vector<cv::Point2d>& points,
                                    double cone_rad, double inset_px, double central_px) {
  RequirePixels(contour, 0, "contour");
  const double least_cos = std::cos(cone_rad);
  std::vector<cv::Point2d> edge;
  for (const cv::Point2d& point : points) {
    const cv::Point2d side = point - centre;
    const double from_centre = cv::norm(side);
    double farthest = 0;
    cv::Point2d outward;
    for (const cv::Point& pixel : contour) {
      const cv::Point2d offset = cv::Point2d(pixel + origin) - centre;
      const double length = cv::norm(offset);
      if (length <= farthest || offset.dot(side) < least_cos * length * from_centre) {
        continue;
      }
      farthest = length;
      outward = offset / length;
    }
    const bool sideless = from_centre == 0 || from_centre < central_px || farthest == 0;
    edge.push_back(sideless ? point : centre + std::max(0.0, farthest - inset_px) * outward);
  }
  return edge;
}

void SnapOnto(const cv::Mat& mask, cv::Point origin, double inset_px,
              std::vector<cv::Point2d>& points) {
  if (points.empty()) return;
  RequireMask(mask, "mask");
  RequirePixels(points, 0, "points");
  cv::Mat target = Inside(mask, inset_px);
  std::vector<std::vector<cv::Point>> borders;
  cv::findContours(target, borders, cv::RETR_LIST, cv::CHAIN_APPROX_NONE, origin);
  if (borders.empty()) {
    target = mask;
    cv::findContours(target, borders, cv::RETR_LIST, cv::CHAIN_APPROX_NONE, origin);
  }
  for (cv::Point2d& point : points) {
    if (Covers(target, cv::Point(cvRound(point.x), cvRound(point.y)) - origin)) continue;
    // The nearest pixel of a region to a point outside it lies on one of its borders.
    cv::Point2d nearest = point;
    double least = std::numeric_limits<double>::infinity();
    for (const std::vector<cv::Point>& border : borders) {
      for (const cv::Point& pixel : border) {
        const cv::Point2d offset = cv::Point2d(pixel) - point;
        if (offset.dot(offset) >= least) continue;
        least = offset.dot(offset);
        nearest = cv::Point2d(pixel);
      }
    }
    point = nearest;
  }
}

}  // namespace gusset
