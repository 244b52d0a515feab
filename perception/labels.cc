#include "perception/labels.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <tuple>

namespace gusset {

std::vector<Label> FindLabels(const cv::Mat& label_colored, const cv::Mat& bag, int most,
                              const PerceptionConfig& config) {
  // Joins the parts of a label that a crease or a noisy pixel divides.
  static const cv::Mat kGap = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::Mat spots;
  cv::morphologyEx(label_colored & bag, spots, cv::MORPH_CLOSE, kGap);
  std::vector<std::vector<cv::Point>> contours;
  cv::findContours(spots, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);

  std::vector<Label> labels;
  for (const std::vector<cv::Point>& contour : contours) {
    const cv::Rect box = cv::boundingRect(contour);
    if (box.area() < config.label_min_px2) continue;
    cv::Mat spot = cv::Mat::zeros(box.size(), CV_8UC1);
    cv::fillPoly(spot, std::vector<std::vector<cv::Point>>{contour}, 255, cv::LINE_8, 0, -box.tl());
    const cv::Moments moments = cv::moments(spot, /*binaryImage=*/true);
    if (moments.m00 < config.label_min_px2) continue;
    labels.push_back({{box.x + moments.m10 / moments.m00, box.y + moments.m01 / moments.m00},
                      static_cast<int>(moments.m00)});
  }
  std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) {
    return std::tuple(-a.area_px2, a.centroid.y, a.centroid.x) <
           std::tuple(-b.area_px2, b.centroid.y, b.centroid.x);
  });
  if (static_cast<int>(labels.size()) > most) labels.resize(most);
  return labels;
}

}  // namespace gusset
