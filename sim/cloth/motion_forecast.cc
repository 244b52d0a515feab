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
}

float MotionForecast::WorstError(const Vec4Array& x) const {
  if (!valid_) return std::numeric_limits<float>::infinity();
  const Vec4f mean = MeanError(x);
  Float4 worst;
  const Float4 mx = mean[0], my = mean[1], mz = mean[2], p = Progress();
  const int count = static_cast<int>(x.size());
  for (int i = 0; i < count; i += 4) {
    const int j = std::min(i + 1, count - 1), k = std::min(i + 2, count - 1),
              l = std::min(i + 3, count - 1);
    Float4 margin;
    const Vec3x4 way = Gather(way_.data(), i, j, k, l, &margin);
    const Vec3x4 off = Gather(x.data(), i, j, k, l) - Gather(start_.data(), i, j, k, l) - way * p -
                       Vec3x4{mx, my, mz};
    worst = Max(worst, Dot(off, off) / (margin * margin));
  }
  alignas(16) float lane[4];
  worst.Store(lane);
  return std::sqrt(std::max(std::max(lane[0], lane[1]), std::max(lane[2], lane[3])));
}

}  // namespace gusset
