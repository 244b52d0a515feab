#pragma once

#include <array>
#include <vector>

#include "sim/cloth/simd.h"

namespace gusset {

/// Where nodes are expected to be for a while, and how far off they may be:
/// what a search for contacts may rely on, and how it learns that it no longer
/// can.
///
/// Node i is forecast at start_i + velocity_i * min(age, horizon), give or take
/// margin_i, up to a translation common to all nodes, which brings none of them
/// closer together. Margins learn: a node that was further off than others gets
/// a wider one for a while, so that one restless corner does not make for new
/// forecasts of the whole cloth again and again.
class MotionForecast {
 public:
  struct Setting {
    float horizon_s;
    float base_m;         ///< Margin of a node that does not move.
    float speed_share;    ///< More margin for a moving one: share of its way to
                          ///< the horizon.
    float learnt_most_m;  ///< More still, at most, for one that was off before.
  };

  /// Forecasts from x on with velocities v.
  void Start(const Setting& setting, const Vec4Array& x, const Vec4Array& v);
  void Age(float h) { age_s_ += h; }
  /// Also forgets what margins have learnt.
  void Invalidate() { valid_ = false; }
  /// Largest errors of two forecasts at x as shares of the nodes' margins; above
  /// 1, or without both forecasts (infinity), nothing can be relied on. Two at a time, for their
  /// sums over all nodes do not wait for each other.
  static std::array<float, 2> WorstErrors(MotionForecast& first, MotionForecast& second,
                                          const Vec4Array& x);

  const Vec4Array& start() const { return start_; }
  /// Whole way to the horizon, less the mean of all nodes; fourth lane: the
  /// margin.
  const Vec4Array& way() const { return way_; }

 private:
  void Learn(const Setting& setting, const Vec4Array& x);
  /// Where nodes are by the forecast: start + way * Progress(), and then the mean
  /// of what all are off by.
  float Progress() const;
  Vec4f MeanError(const Vec4Array& x) const;
  float Worst(const Vec4f& mean) const;

  bool valid_ = false;
  float age_s_ = 0;
  float horizon_s_ = 0;
  Vec4Array start_, way_;
  std::vector<float> learnt_m_;
  // Whole fours.
  Vec4Array off_;               ///< Scratch: what nodes are off by.
  std::vector<float> margin2_;  ///< Margins, squared.
};

}  // namespace gusset
