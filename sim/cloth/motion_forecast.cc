#include "sim/cloth/motion_forecast.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gusset {
namespace {

// Tuned 2026-11 with the settings of SelfContact for the least time (docs/physics.md).
constexpr float kKept = 0.8f;          // what a new forecast keeps of a learnt margin
constexpr float kUnremarkable = 0.2f;  // share of the other margins that any node may be off by
constexpr float kMostGrowth = 3.0f;    // from a forecast's age to its horizon

}  // namespace

float MotionForecast::Progress() const { return std::min(age_s_ / horizon_s_, 1.0f); }

Vec4f MotionForecast::MeanError(const Vec4Array& x) const {
  const float part = Progress();
  Vec4f mean = Vec4f::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) mean += x[i] - start_[i] - way_[i] * part;
  mean /= static_cast<float>(x.size());
  return mean;
}

// How far off the forecast was, as if it had gone on to its horizon.
void MotionForecast::Learn(const Setting& setting, const Vec4Array& x) {
  if (!valid_) learnt_m_.assign(x.size(), 0.0f);
  if (!valid_ || age_s_ <= 0) return;
  const float part = Progress();
  const Vec4f mean = MeanError(x);
  const float grown = std::min(horizon_s_ / age_s_, kMostGrowth);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec4f off = x[i] - start_[i] - way_[i] * part - mean;
    const float known = setting.base_m + setting.speed_share * way_[i].head<3>().norm();
    const float wanted = std::clamp(off.head<3>().norm() * grown - kUnremarkable * known, 0.0f,
                                    setting.learnt_most_m);
    learnt_m_[i] = std::max(learnt_m_[i] * kKept, wanted);
  }
}

void MotionForecast::Start(const Setting& setting, const Vec4Array& x, const Vec4Array& v) {
  Learn(setting, x);
  start_ = x;
  way_.resize(x.size());
  horizon_s_ = setting.horizon_s;
  age_s_ = 0;
  valid_ = true;
  Vec4f mean = Vec4f::Zero();
  for (const Vec4f& vi : v) mean += vi;
  mean /= static_cast<float>(v.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    way_[i] = (v[i] - mean) * setting.horizon_s;
    way_[i][3] = setting.base_m + setting.speed_share * way_[i].norm() + learnt_m_[i];
  }
  off_.resize((x.size() + 3) / 4 * 4);
  margin2_.resize(off_.size());
  for (std::size_t i = 0; i < margin2_.size(); ++i) {
    const float margin = way_[std::min(i, x.size() - 1)][3];
    margin2_[i] = margin * margin;
  }
}

// What is left of an error once the mean of all is taken off, as a share of the margin.
float MotionForecast::Worst(const Vec4f& mean) const {
  Float4 worst;
  const Vec3x4 common = {mean[0], mean[1], mean[2]};
  for (std::size_t i = 0; i < off_.size(); i += 4) {
    const int k = static_cast<int>(i);
    const Vec3x4 off = Gather(off_.data(), k, k + 1, k + 2, k + 3) - common;
    worst = Max(worst, Dot(off, off) / Loadu(&margin2_[i]));
  }
  alignas(16) float lane[4];
  worst.Store(lane);
  return std::sqrt(std::max(std::max(lane[0], lane[1]), std::max(lane[2], lane[3])));
}

std::array<float, 2> MotionForecast::WorstErrors(MotionForecast& first, MotionForecast& second,
                                                 const Vec4Array& x) {
  if (!first.valid_ || !second.valid_) {
    const float none = std::numeric_limits<float>::infinity();
    return {none, none};
  }
  const std::size_t count = x.size();
  const Float4 part_1 = first.Progress(), part_2 = second.Progress();
  Float4 sum_1, sum_2;
  for (std::size_t i = 0; i < count; ++i) {
    const auto error = [&](MotionForecast& of, Float4 part) {
      const Float4 off = Float4::Load(x[i].data()) - Float4::Load(of.start_[i].data()) -
                         Float4::Load(of.way_[i].data()) * part;
      off.Store(of.off_[i].data());
      return off;
    };
    sum_1 = sum_1 + error(first, part_1);
    sum_2 = sum_2 + error(second, part_2);
  }
  std::array<float, 2> worst;
  for (int k = 0; k < 2; ++k) {
    MotionForecast& of = k == 0 ? first : second;
    // Whole fours: the last node once more.
    for (std::size_t i = count; i < of.off_.size(); ++i) of.off_[i] = of.off_[count - 1];
    Vec4f mean;
    (k == 0 ? sum_1 : sum_2).Store(mean.data());
    mean /= static_cast<float>(count);
    worst[k] = of.Worst(mean);
  }
  return worst;
}

}  // namespace gusset
