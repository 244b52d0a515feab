#include "tools/gusset/corpus_score.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "perception/opening_area.h"
#include "sim/top_view.h"
#include "tools/gusset/frame_truth.h"

namespace gusset {
namespace {

/// The rim's row of grasp points lies 0.5/9 of the body from the rim, 20 mm on Bag 1; meant for the
/// rim is what lies within twice that.
constexpr double kRimBand_m = 0.04;

const double kRoom_px = PerceptionConfig().place_inset_px;

constexpr const char* kPointNames[] = {"s0 grasp points on the bag",
                                       "s0 edge points on the bag",
                                       "s1 grasp points within 40 mm of the rim",
                                       "s1 drag targets on the bag",
                                       "s2 place points inside the mouth",
                                       "the same, of a mouth with room for it",
                                       "s3 grasp points on the bag"};

State StateByAreas(int labels, double A_bag, double A_o, const BagThresholds& thresholds) {
  Evidence evidence;
  evidence.bag_seen = true;
  evidence.labels_seen = labels;
  evidence.A_bag = A_bag;
  evidence.A_o = A_o;
  return ClassifyState(evidence, thresholds).state;
}

// The mouth if all labels showed more by this share of what they show.
struct Mouth {
  double share;
  int labels;
  double A_o;
};

Mouth MouthBeside(const LabelledFrame& truth, double share, double label_min_px2) {
  std::vector<cv::Point2d> seen;
  for (const LabelledFrame::Label& label : truth.shown) {
    if (label.px2 * (1 + share) >= label_min_px2) seen.push_back(label.centre_px);
  }
  return {share, static_cast<int>(seen.size()), MeasureOpening(seen).area_px2};
}

bool IsCloth(Shown shown) { return shown != Shown::kNothing && shown != Shown::kCube; }
bool IsInside(Shown shown) { return shown == Shown::kInner0 || shown == Shown::kInner1; }

std::string Line(const char* format, auto... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

// "99.54 %", or "-" for a share of nothing.
std::string Percent(const nlohmann::ordered_json& share) {
  return share.is_null() ? "-" : Line("%.2f %%", 100 * share.get<double>());
}

nlohmann::ordered_json Json(const Spread& spread) {
  return {{"count", spread.count()}, {"bias", spread.mean()}, {"spread", spread.deviation()}};
}

}  // namespace

std::optional<double> ThresholdMargin(const LabelledFrame& truth, const BagThresholds& thresholds,
                                      double label_min_px2) {
  if (!truth.has_areas || static_cast<int>(truth.state) > 2) return std::nullopt;
  // Areas at which a share s of change puts either exactly onto a threshold, and a hair beyond.
  constexpr double kHair = 1e-9;
  const auto change_to = [](double area, double threshold) {
    return area > 0 ? threshold / area - 1 : 1;
  };
  std::vector<Mouth> mouths = {{0, truth.labels, truth.A_o}};
  for (const LabelledFrame::Label& label : truth.shown) {
    const double to_floor = change_to(label.px2, label_min_px2);
    if (std::abs(to_floor) > kNearThreshold) continue;
    for (const double share : {to_floor - kHair, to_floor + kHair}) {
      mouths.push_back(MouthBeside(truth, share, label_min_px2));
    }
  }
  const double to_th = change_to(truth.A_bag, thresholds.A_th);
  const double to_open = change_to(truth.A_bag, kOpenBagShare * thresholds.A_flat);
  std::optional<double> least;
  for (const Mouth& mouth : mouths) {
    const double to_oth = change_to(mouth.A_o, thresholds.A_oth);
    for (const double bag : {0.0, to_th - kHair, to_th + kHair, to_open - kHair, to_open + kHair}) {
      for (const double opening : {0.0, to_oth - kHair, to_oth + kHair}) {
        const double share = std::max({std::abs(bag), std::abs(opening), std::abs(mouth.share)});
        if (share > kNearThreshold || (least && share >= *least)) continue;
        if (StateByAreas(mouth.labels, truth.A_bag * (1 + bag), mouth.A_o * (1 + opening),
                         thresholds) != truth.state) {
          least = share;
        }
      }
    }
  }
  return least;
}

void Spread::Add(double value) {
  ++count_;
  sum_ += value;
  sum2_ += value * value;
}

double Spread::deviation() const {
  if (count_ < 2) return 0;
  const double n = static_cast<double>(count_);
  return std::sqrt(std::max(0.0, (sum2_ - sum_ * sum_ / n) / (n - 1)));
}

bool CorpusScore::Add(const LabelledFrame& truth, const BagThresholds& thresholds,
                      std::optional<double> margin, const Observation& seen,
                      const cv::Mat& surface) {
  ++frames_;
  worlds_.insert(truth.world.empty() ? truth.color.string() : truth.world);
  const auto t = static_cast<std::size_t>(truth.state);
  const bool right = seen.state == truth.state;
  if (margin) {
    Share& share = near_[std::min<std::size_t>(2, static_cast<std::size_t>(100 * *margin))];
    ++share.of;
    share.right += right;
  } else {
    ++confusion_[t][static_cast<std::size_t>(seen.state)];
  }
  if (truth.has_areas && truth.A_bag > 0 && seen.bag_seen) {
    bag_share_[t].Add(seen.A_bag / truth.A_bag - 1);
    bag_px2_[t].Add(seen.A_bag - truth.A_bag);
    opening_px2_[t].Add(seen.A_o - truth.A_o);
    if (truth.A_o > thresholds.A_oth) opening_share_[t].Add(seen.A_o / truth.A_o - 1);
    ++mouth_.of;
    mouth_.right += seen.mouth_seen == (truth.labels >= kLabelsOfMouth);
  }
  if (truth.cube_m && seen.cube) {
    for (int k = 0; k < 3; ++k) cube_mm_[k].Add(1000 * (seen.cube->p_W - *truth.cube_m)[k]);
  }
  if (right && !surface.empty()) AddPoints(seen, surface);
  return right;
}

void CorpusScore::AddPoints(const Observation& seen, const cv::Mat& surface) {
  const auto count = [&](PointKind kind, const std::vector<PosePoint>& points, auto is_meant) {
    for (const PosePoint& point : points) {
      const cv::Point at(cvRound(point.px.x), cvRound(point.px.y));
      ++points_[kind].of;
      if (!cv::Rect({0, 0}, surface.size()).contains(at)) continue;
      const auto& pixel = surface.at<cv::Vec3b>(at);
      points_[kind].right += is_meant(static_cast<Shown>(pixel[0]), pixel[1] * kRimStep_m);
    }
  };
  const auto on_bag = [](Shown shown, double) { return IsCloth(shown); };
  const auto in_mouth = [](Shown shown, double) { return IsInside(shown); };
  switch (seen.state) {
    case State::kFolded:
      count(kS0Grasp, seen.grasp_points, on_bag);
      count(kS0Edge, seen.edge_points, on_bag);
      break;
    case State::kUnfolded:
      count(kS1Grasp, seen.grasp_points,
            [](Shown shown, double rim_m) { return IsCloth(shown) && rim_m <= kRimBand_m; });
      count(kS1Target, seen.place_points, on_bag);
      break;
    case State::kOpen:
      count(kS2Place, seen.place_points, in_mouth);
      // Into a narrower mouth nothing is placed.
      if (seen.width && seen.width->closed && seen.width->radius_px >= kRoom_px) {
        count(kS2Room, seen.place_points, in_mouth);
      }
      break;
    case State::kFilled:
      count(kS3Grasp, seen.grasp_points, on_bag);
      break;
    case State::kSuccess:
    case State::kFail:
      break;
  }
}

nlohmann::ordered_json CorpusScore::Report() const {
  nlohmann::ordered_json states = nlohmann::ordered_json::array();
  Share all;
  for (int t = 0; t < kStates; ++t) {
    Share share;
    for (int s = 0; s < kStates; ++s) share.of += confusion_[t][s];
    share.right = confusion_[t][t];
    all.of += share.of;
    all.right += share.right;
    states.push_back({{"state", StateName(static_cast<State>(t))},
                      {"frames", share.of},
                      {"right", share.right},
                      {"accuracy", share.value()},
                      {"A_bag_relative", Json(bag_share_[t])},
                      {"A_bag_px2", Json(bag_px2_[t])},
                      {"A_o_relative", Json(opening_share_[t])},
                      {"A_o_px2", Json(opening_px2_[t])}});
  }
  nlohmann::ordered_json near = nlohmann::ordered_json::array();
  for (std::size_t k = 0; k < near_.size(); ++k) {
    near.push_back({{"margin_below", 0.01 * static_cast<double>(k + 1)},
                    {"frames", near_[k].of},
                    {"right", near_[k].right}});
  }
  nlohmann::ordered_json points = nlohmann::ordered_json::array();
  for (int k = 0; k < kPointKinds; ++k) {
    points.push_back(
        {{"points", kPointNames[k]}, {"count", points_[k].of}, {"share", points_[k].value()}});
  }
  return {
      {"frames", frames_},
      {"bags", worlds_.size()},
      {"clear_frames", all.of},
      {"right", all.right},
      {"accuracy", all.value()},
      {"states", states},
      {"confusion", confusion_},
      {"near_thresholds", near},
      {"mouth_seen_right", mouth_.value()},
      {"cube_mm", {{"x", Json(cube_mm_[0])}, {"y", Json(cube_mm_[1])}, {"z", Json(cube_mm_[2])}}},
      {"pose_points", points}};
}

std::string CorpusScore::Text() const {
  const nlohmann::ordered_json report = Report();
  const auto clear = report["clear_frames"].get<long>();
  std::string text = Line("%ld frames of %zu bags; %ld within 3 %% of a threshold are apart\n",
                          frames_, worlds_.size(), frames_ - clear);
  text += Line("accuracy %s (%ld of %ld)\n\n", Percent(report["accuracy"]).c_str(),
               report["right"].get<long>(), clear);
  text += "true \\ seen      s0      s1      s2      s3      s4      s5   right\n";
  for (int t = 0; t < kStates; ++t) {
    text += Line("s%d         ", t);
    for (int s = 0; s < kStates; ++s) text += Line("%8ld", confusion_[t][s]);
    text += Line("  %8s\n", Percent(report["states"][t]["accuracy"]).c_str());
  }
  text += "\nmargin to the threshold   frames   right\n";
  for (std::size_t k = 0; k < near_.size(); ++k) {
    text += Line("%zu to %zu %%                 %8ld%8ld\n", k, k + 1, near_[k].of, near_[k].right);
  }
  text +=
      "\nseen less true     A_bag, %        A_bag, px^2      A_o, px^2        A_o above A_oth, %\n";
  for (int t = 0; t < 4; ++t) {
    text += Line("s%d             %+7.2f +-%5.2f  %+7.0f +-%5.0f  %+7.0f +-%5.0f  %+7.1f +-%5.1f\n",
                 t, 100 * bag_share_[t].mean(), 100 * bag_share_[t].deviation(), bag_px2_[t].mean(),
                 bag_px2_[t].deviation(), opening_px2_[t].mean(), opening_px2_[t].deviation(),
                 100 * opening_share_[t].mean(), 100 * opening_share_[t].deviation());
  }
  text += Line("\ncube, mm (%ld frames): x %+.2f +- %.2f, y %+.2f +- %.2f, z %+.2f +- %.2f\n",
               cube_mm_[0].count(), cube_mm_[0].mean(), cube_mm_[0].deviation(), cube_mm_[1].mean(),
               cube_mm_[1].deviation(), cube_mm_[2].mean(), cube_mm_[2].deviation());
  text +=
      Line("mouth seen or not as it is: %s of %ld\n\n", Percent(mouth_.value()).c_str(), mouth_.of);
  for (int k = 0; k < kPointKinds; ++k) {
    if (points_[k].of == 0) continue;
    text += Line("%-42s %9s of %ld\n", kPointNames[k], Percent(points_[k].value()).c_str(),
                 points_[k].of);
  }
  return text;
}

}  // namespace gusset
