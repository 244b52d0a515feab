#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "perception/config.h"
#include "perception/observation.h"
#include "tools/gusset/corpus.h"

namespace gusset {

/// Areas this near (relative) to a threshold may fall on either side of it.
inline constexpr double kNearThreshold = 0.03;

/// The smallest share of its own by which A_bag, A_o or what the labels show would have to differ
/// for another state, as the state table has it; std::nullopt where no change up to kNearThreshold
/// of any of them does. Only s0, s1 and s2 depend on areas.
/// @param label_min_px2 of a label that shows less there is none: the state table's noise floor.
std::optional<double> ThresholdMargin(const LabelledFrame& truth, const BagThresholds& thresholds,
                                      double label_min_px2);

/// Mean and spread of a quantity.
class Spread {
 public:
  void Add(double value);
  long count() const { return count_; }
  double mean() const { return count_ > 0 ? sum_ / static_cast<double>(count_) : 0; }
  double deviation() const;  ///< Standard deviation; 0 for fewer than two values.

 private:
  long count_ = 0;
  double sum_ = 0, sum2_ = 0;
};

/// Compares what perception saw with the labels, frame by frame.
class CorpusScore {
 public:
  /// @param margin of the frame, by ThresholdMargin.
  /// @param surface see FrameTruth::surface; empty where the corpus has none.
  /// @returns true if the state is right.
  bool Add(const LabelledFrame& truth, const BagThresholds& thresholds,
           std::optional<double> margin, const Observation& seen, const cv::Mat& surface);

  /// Keys: see docs/perception.md.
  nlohmann::ordered_json Report() const;
  /// The report for people.
  std::string Text() const;

 private:
  static constexpr int kStates = 6;
  /// What pose points are meant for, by state.
  enum PointKind {
    kS0Grasp,
    kS0Edge,
    kS1Grasp,
    kS1Target,
    kS2Place,
    kS2Room,
    kS3Grasp,
    kPointKinds
  };
  struct Share {
    long right = 0, of = 0;
    /// Null if of none.
    nlohmann::ordered_json value() const {
      if (of == 0) return nullptr;
      return static_cast<double>(right) / static_cast<double>(of);
    }
  };
  void AddPoints(const Observation& seen, const cv::Mat& surface);

  long frames_ = 0;
  std::set<std::string> worlds_;
  std::array<std::array<long, kStates>, kStates> confusion_{};  ///< [true][seen], clear frames.
  std::array<Share, 3> near_{};                                 ///< By margin: below 1 %, 2 %, 3 %.
  Share mouth_;  ///< Frames that agree on whether the mouth is seen.
  std::array<Spread, kStates> bag_share_, bag_px2_, opening_px2_, opening_share_;
  std::array<Spread, 3> cube_mm_;
  std::array<Share, kPointKinds> points_{};
};

}  // namespace gusset
