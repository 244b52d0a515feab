#include "perception/bag_body.h"

#include <opencv2/imgproc.hpp>

#include "perception/require.h"

namespace gusset {
namespace {

using Contours = std::vector<std::vector<cv::Point>>;

/// cv::findContours with RETR_CCOMP: hierarchy entries are {next, previous, first child, parent}.
constexpr int kNext = 0;
constexpr int kFirstChild = 2;
constexpr int kParent = 3;

void EraseHole(const Contours& contours, int hole, cv::Mat& mask) {
  cv::drawContours(mask, contours, hole, 0, cv::FILLED);
  // OpenCV traces a hole along the pixels around it, which belong to the body.
  cv::drawContours(mask, contours, hole, 255, 1);
}

}  // namespace

std::optional<BagBody> FindBag(const cv::Mat& cloth, const PerceptionConfig& config) {
  RequireMask(cloth, "cloth");
  // Opening drops specks and thin strokes, closing then bridges creases of up to six pixels.
  static const cv::Mat kSpeck = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  static const cv::Mat kCrease = cv::getStructuringElement(cv::MORPH_RECT, {7, 7});
  // Cloth and, so that closing has room, a crease's width round it; the rest stays empty.
  cv::Rect part = cv::boundingRect(cloth);
  part -= cv::Point(kCrease.cols, kCrease.rows);
  part += kCrease.size() * 2;
  part &= cv::Rect({0, 0}, cloth.size());
  cv::Mat body;
  cv::morphologyEx(cloth(part), body, cv::MORPH_OPEN, kSpeck);
  cv::morphologyEx(body, body, cv::MORPH_CLOSE, kCrease);

  Contours contours;
  std::vector<cv::Vec4i> tree;
  cv::findContours(body, contours, tree, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE, part.tl());
  int largest = -1;
  double largest_area = 0;
  for (int i = 0; i < static_cast<int>(contours.size()); ++i) {
    if (tree[i][kParent] >= 0) continue;
    const double area = cv::contourArea(contours[i]);
    if (area < config.bag_min_px2 || area > config.bag_max_px2 || area <= largest_area) continue;
    largest = i;
    largest_area = area;
  }
  if (largest < 0) return std::nullopt;

  BagBody bag;
  bag.mask = cv::Mat::zeros(cloth.size(), CV_8UC1);
  cv::drawContours(bag.mask, contours, largest, 255, cv::FILLED);
  for (int hole = tree[largest][kFirstChild]; hole >= 0; hole = tree[hole][kNext]) {
    if (cv::contourArea(contours[hole]) > config.hole_max_px2) {
      EraseHole(contours, hole, bag.mask);
    }
  }
  bag.contour = std::move(contours[largest]);
  bag.area_px2 = cv::countNonZero(bag.mask);
  const cv::Rect box = cv::boundingRect(bag.contour);
  bag.at_border = (box & cv::Rect(1, 1, cloth.cols - 2, cloth.rows - 2)) != box;
  return bag;
}

}  // namespace gusset
