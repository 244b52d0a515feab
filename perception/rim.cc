#include "perception/rim.h"

#include <algorithm>

#include "perception/require.h"
#include "perception/shapes.h"

namespace gusset {

cv::Point2d RimDirection(const cv::Mat& bag, const std::vector<cv::Point2d>& labels,
                         cv::Point origin, double reach_px) {
  RequireMask(bag, "bag");
  RequirePixels(labels, 0, "labels");
  cv::Point2d direction(0, 0);
  const int reach = static_cast<int>(std::ceil(reach_px));
  for (const cv::Point2d& label : labels) {
    const cv::Point2d at = label - cv::Point2d(origin);
    const cv::Point middle(cvRound(at.x), cvRound(at.y));
    const cv::Rect around =
        cv::Rect(middle.x - reach, middle.y - reach, 2 * reach + 1, 2 * reach + 1) &
        cv::Rect({0, 0}, bag.size());
    cv::Point2d sum(0, 0);
    int count = 0;
    for (int y = around.y; y < around.br().y; ++y) {
      for (int x = around.x; x < around.br().x; ++x) {
        const cv::Point2d offset = cv::Point2d(x, y) - at;
        if (bag.at<uchar>(y, x) == 0 || offset.dot(offset) > reach_px * reach_px) continue;
        sum += offset;
        ++count;
      }
    }
    if (count > 0) direction -= sum / count;
  }
  const double norm = cv::norm(direction);
  return norm > 0 ? direction / norm : cv::Point2d(0, -1);
}

std::array<cv::Point2d, 4> CornersFromRow(const Outline& outline,
                                          const std::vector<cv::Point2d>& row, cv::Point2d outward,
                                          double inset_px) {
  RequirePixels(row, 2, "row");
  const FittedLine line = FitLine(row);
  cv::Point2d along = line.along;
  // Against the clock as one sees the image, what is outside is to the right of one's way.
  cv::Point2d across(-along.y, along.x);
  double least = line.least, most = line.most;
  if (across.dot(outward) < 0) {
    along = -along;
    across = -across;
    least = -line.most;
    most = -line.least;
  }
  const double beyond = 0.5 * (most - least) / (static_cast<double>(row.size()) - 1);
  const cv::Point2d middle = line.mean + inset_px * across;
  const std::array<cv::Point2d, 4> counted = outline.From(SideTowards(outline, across)).corners;
  return {middle + (least - beyond) * along, middle + (most + beyond) * along, counted[2],
          counted[3]};
}

}  // namespace gusset
