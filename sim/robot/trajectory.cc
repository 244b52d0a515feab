#include "sim/robot/trajectory.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace gusset {
namespace {

// Timing cells per spline segment. Limits are checked at the cells' ends; within a cell the
// spline's second derivative is linear, so little can happen in between.
constexpr int kGridPerSegment = 4;
// Of the acceleration budget, what bending of the path may use up; the rest drives along it. tuned
constexpr double kBendShare = 0.5;

}  // namespace

Trajectory::Trajectory(const JointVector& q)
    : joints_{q, q},
      curvature_(2, JointVector::Zero(q.size())),
      grid_speed_(kGridPerSegment + 1, 0.0),
      times_s_(kGridPerSegment + 1, 0.0) {}

Trajectory::Trajectory(const std::vector<JointVector>& joints,
                       const std::vector<Eigen::Vector3d>& tool_m, const ArmLimits& limits,
                       const PathLimits& path_limits)
    : joints_(joints) {
  assert(joints.size() >= 2 && tool_m.size() == joints.size());
  FitSpline();
  Time(tool_m, limits, path_limits);
}

// Natural spline: M[k-1] + 4 M[k] + M[k+1] = 6 (q[k-1] - 2 q[k] + q[k+1]), M = 0 at both ends,
// by Thomas's algorithm for all joints at once.
void Trajectory::FitSpline() {
  const int n = static_cast<int>(joints_.size());
  curvature_.assign(n, JointVector::Zero(joints_[0].size()));
  std::vector<double> upper(n, 0.0);
  for (int k = 1; k + 1 < n; ++k) {
    const double pivot = 4 - upper[k - 1];
    upper[k] = 1 / pivot;
    curvature_[k] =
        (6 * (joints_[k - 1] - 2 * joints_[k] + joints_[k + 1]) - curvature_[k - 1]) / pivot;
  }
  for (int k = n - 2; k > 0; --k) curvature_[k] -= upper[k] * curvature_[k + 1];
}

void Trajectory::SplineAt(int segment, double x, JointState& by_s) const {
  const JointVector& q0 = joints_[segment];
  const JointVector& q1 = joints_[segment + 1];
  const JointVector& m0 = curvature_[segment];
  const JointVector& m1 = curvature_[segment + 1];
  const double y = 1 - x;
  by_s.q = y * q0 + x * q1 + ((y * y * y - y) * m0 + (x * x * x - x) * m1) / 6;
  by_s.qd = q1 - q0 + ((1 - 3 * y * y) * m0 + (3 * x * x - 1) * m1) / 6;
  by_s.qdd = y * m0 + x * m1;
}

// Time-optimal but for the fixed split between bending and driving: for w = (ds/dt)^2,
//   |q'| sqrt(w) <= v,  |q''| w <= kBendShare a  bound w at each grid point, and
//   |q'| |d2s/dt2| <= a - |q''| w_max  bounds its slope, dw/ds = 2 d2s/dt2:
// one pass forwards and one backwards. Always feasible, since standing still is.
void Trajectory::Time(const std::vector<Eigen::Vector3d>& tool_m, const ArmLimits& limits,
                      const PathLimits& path_limits) {
  const int segments = static_cast<int>(joints_.size()) - 1;
  const int cells = segments * kGridPerSegment;
  const double ds = 1.0 / kGridPerSegment;
  const auto ratio = [](const JointVector& budget, const JointVector& use) {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < use.size(); ++i) {
      if (std::abs(use[i]) > 1e-12) least = std::min(least, budget[i] / std::abs(use[i]));
    }
    return least;
  };
  const JointVector a = path_limits.acceleration_share * limits.acceleration;
  std::vector<double> w(cells + 1), drive(cells + 1);
  JointState by_s;
  for (int g = 0; g <= cells; ++g) {
    const int segment = std::min(g / kGridPerSegment, segments - 1);
    SplineAt(segment, g * ds - segment, by_s);
    // Tool metres per unit of s, the larger of the segments that meet here.
    double metres = (tool_m[segment + 1] - tool_m[segment]).norm();
    if (g > 0) {
      const int before = std::min((g - 1) / kGridPerSegment, segments - 1);
      metres = std::max(metres, (tool_m[before + 1] - tool_m[before]).norm());
    }
    double speed = ratio(limits.velocity, by_s.qd);
    if (metres > 1e-9) speed = std::min(speed, path_limits.tool_speed_m_s / metres);
    w[g] = std::min({speed * speed, ratio(kBendShare * a, by_s.qdd), 1e12});
    drive[g] = ratio(a - w[g] * by_s.qdd.cwiseAbs(), by_s.qd);
    if (metres > 1e-9) drive[g] = std::min(drive[g], path_limits.tool_acceleration_m_s2 / metres);
    drive[g] = std::min(drive[g], 1e12);
  }
  w.front() = w.back() = 0;
  for (int g = 0; g < cells; ++g) {
    w[g + 1] = std::min(w[g + 1], w[g] + 2 * ds * std::min(drive[g], drive[g + 1]));
  }
  for (int g = cells; g > 0; --g) {
    w[g - 1] = std::min(w[g - 1], w[g] + 2 * ds * std::min(drive[g], drive[g - 1]));
  }
  grid_speed_.resize(cells + 1);
  times_s_.assign(cells + 1, 0.0);
  for (int g = 0; g <= cells; ++g) grid_speed_[g] = std::sqrt(w[g]);
  for (int g = 0; g < cells; ++g) {
    times_s_[g + 1] = times_s_[g] + 2 * ds / (grid_speed_[g] + grid_speed_[g + 1]);
  }
}

void Trajectory::Evaluate(double t_s, JointState& state) const {
  const int cells = static_cast<int>(times_s_.size()) - 1;
  const auto next = std::upper_bound(times_s_.begin(), times_s_.end(), t_s);
  const int g = std::clamp(static_cast<int>(next - times_s_.begin()) - 1, 0, cells - 1);
  const double cell_s = times_s_[g + 1] - times_s_[g];
  double x = 0, speed = 0, acceleration = 0;  // of s within the cell
  if (t_s >= times_s_.back()) {
    x = 1.0 / kGridPerSegment;
  } else if (t_s > 0 && cell_s > 0) {
    const double t = t_s - times_s_[g];
    acceleration = (grid_speed_[g + 1] - grid_speed_[g]) / cell_s;
    speed = grid_speed_[g] + acceleration * t;
    x = grid_speed_[g] * t + 0.5 * acceleration * t * t;
  }
  const int segment = g / kGridPerSegment;
  const double offset = static_cast<double>(g % kGridPerSegment) / kGridPerSegment;
  SplineAt(segment, std::clamp(offset + x, 0.0, 1.0), state);
  state.qdd = state.qdd * (speed * speed) + state.qd * acceleration;
  state.qd *= speed;
}

}  // namespace gusset
