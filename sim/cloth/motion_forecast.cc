#include "sim/cloth/motion_forecast.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gusset {

void MotionForecast::Start(const Setting& setting, const Vec4Array& x, const Vec4Array& v) {
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
    way_[i][3] = setting.base_m + setting.speed_share * way_[i].norm();
  }
}

float MotionForecast::WorstError(const Vec4Array& x) const {
  if (!valid_) return std::numeric_limits<float>::infinity();
  const float part = std::min(age_s_ / horizon_s_, 1.0f);
  Vec4f mean = Vec4f::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) mean += x[i] - start_[i] - way_[i] * part;
  mean /= static_cast<float>(x.size());
  Float4 worst;
  const Float4 mx = mean[0], my = mean[1], mz = mean[2], p = part;
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
