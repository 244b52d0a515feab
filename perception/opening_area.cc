#include "perception/opening_area.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "perception/require.h"
#include "perception/shapes.h"

namespace gusset {
namespace {

double Cross(cv::Point2d a, cv::Point2d b) { return a.x * b.y - a.y * b.x; }

std::size_t ClosestNode(cv::Point2d to, const std::vector<cv::Point2d>& points) {
  const auto distance2 = [to](cv::Point2d p) { return (p - to).dot(p - to); };
  return std::min_element(
             points.begin(), points.end(),
             [&](cv::Point2d a, cv::Point2d b) { return distance2(a) < distance2(b); }) -
         points.begin();
}

std::vector<Triangle> Algorithm7(cv::Point2d centre, std::vector<cv::Point2d> points) {
  std::vector<Triangle> triangles;
  while (points.size() >= 3) {
    const std::size_t i = ClosestNode(centre, points);
    const cv::Point2d n = points[i];
    points.erase(points.begin() + i);
    std::vector<cv::Point2d> others = points;
    const std::size_t j = ClosestNode(n, others);
    triangles.push_back({centre, n, others[j]});
    others.erase(others.begin() + j);
    triangles.push_back({centre, n, others[ClosestNode(n, others)]});
  }
  return triangles;
}

/// The side of a triangle opposite the centre, seen from the centre: from angle `begin`
/// anticlockwise by less than pi.
struct Segment {
  cv::Point2d a, b;  ///< Relative to the centre.
  double begin, end;

  /// Distance from the centre at which the ray with this unit direction meets the line a-b.
  double Reach(cv::Point2d direction) const { return Cross(a, b - a) / Cross(direction, b - a); }
};

void AddSegment(cv::Point2d a, cv::Point2d b, std::vector<Segment>& segments) {
  if (Cross(a, b) < 0) std::swap(a, b);
  // No area; also keeps Reach() away from a division by nothing.
  if (Cross(a, b) <= 1e-9 * (a.dot(a) + b.dot(b))) return;
  const double begin = std::atan2(a.y, a.x);
  const double end = std::atan2(b.y, b.x);
  if (end > begin) {
    segments.push_back({a, b, begin, end});
    return;
  }
  // Across the cut of atan2: once at each end of the full turn.
  segments.push_back({a, b, begin, std::numbers::pi});
  segments.push_back({a, b, -std::numbers::pi, end});
}

/// All angles between which the outermost segment does not change: ends and crossings.
std::vector<double> Breaks(const std::vector<Segment>& segments) {
  std::vector<double> breaks;
  for (const Segment& s : segments) {
    breaks.push_back(s.begin);
    breaks.push_back(s.end);
    for (const Segment& t : segments) {
      const cv::Point2d along_s = s.b - s.a;
      const double denominator = Cross(along_s, t.b - t.a);
      if (denominator == 0) continue;
      const double at = Cross(t.a - s.a, t.b - t.a) / denominator;
      if (!(at > 0 && at < 1)) continue;
      const cv::Point2d crossing = s.a + at * along_s;
      breaks.push_back(std::atan2(crossing.y, crossing.x));
    }
  }
  std::sort(breaks.begin(), breaks.end());
  return breaks;
}

}  // namespace

Opening MeasureOpening(std::vector<cv::Point2d> points) {
  Opening opening;
  if (points.empty()) return opening;
  RequirePixels(points, 0, "points");
  SortByXThenY(points);
  cv::Point2d mean(0, 0);
  for (const cv::Point2d& point : points) mean += point;
  mean /= static_cast<double>(points.size());
  opening.centre = mean;
  opening.triangles = Algorithm7(mean, points);

  // Every triangle has the centre as a vertex, so the union is star-shaped: between two
  // neighbouring breaks it is the triangle under the outermost segment there.
  std::vector<Segment> segments;
  for (const Triangle& triangle : opening.triangles) {
    AddSegment(triangle[1] - mean, triangle[2] - mean, segments);
  }
  const std::vector<double> breaks = Breaks(segments);
  cv::Point2d moment(0, 0);
  for (std::size_t k = 1; k < breaks.size(); ++k) {
    const double middle = 0.5 * (breaks[k - 1] + breaks[k]);
    const cv::Point2d ray(std::cos(middle), std::sin(middle));
    const Segment* outermost = nullptr;
    double reach = 0;
    for (const Segment& segment : segments) {
      if (middle < segment.begin || middle > segment.end || segment.Reach(ray) <= reach) continue;
      outermost = &segment;
      reach = segment.Reach(ray);
    }
    if (outermost == nullptr || !(breaks[k] > breaks[k - 1])) continue;
    const cv::Point2d from(std::cos(breaks[k - 1]), std::sin(breaks[k - 1]));
    const cv::Point2d to(std::cos(breaks[k]), std::sin(breaks[k]));
    const cv::Point2d p = from * outermost->Reach(from);
    const cv::Point2d q = to * outermost->Reach(to);
    const double area = 0.5 * Cross(p, q);
    opening.area_px2 += area;
    moment += area / 3 * (p + q);
  }
  if (opening.area_px2 > 0) opening.centre = mean + moment / opening.area_px2;
  return opening;
}

}  // namespace gusset
