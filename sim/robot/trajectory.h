#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/robot/arm_model.h"

namespace gusset {

/// Joint position, speed and acceleration at one time.
struct JointState {
  JointVector q, qd, qdd;
};

/// What a path is timed against, on top of the joints' limits.
struct PathLimits {
  double tool_speed_m_s = 0;          ///< > 0.
  double tool_acceleration_m_s2 = 0;  ///< Along the path; > 0.
  double acceleration_share = 1;      ///< Of the joints' acceleration limits.
};

/// A joint path with its timing: from rest to rest, as fast as the limits let it. The path is the
/// C2 cubic spline through the given joints, at equal steps of the path parameter s = 0, 1, 2, ...;
/// s(t) has piecewise constant acceleration.
class Trajectory {
 public:
  /// Stands still at q.
  explicit Trajectory(const JointVector& q);
  /// @param joints  at least two waypoints.
  /// @param tool_m  the tool's position at each of them.
  /// O(waypoints x joints).
  Trajectory(const std::vector<JointVector>& joints, const std::vector<Eigen::Vector3d>& tool_m,
             const ArmLimits& limits, const PathLimits& path_limits);

  double duration_s() const { return times_s_.back(); }
  /// State at time t_s, clamped to [0, duration]. Writes into `state` to spare allocations.
  void Evaluate(double t_s, JointState& state) const;
  const JointVector& start() const { return joints_.front(); }
  const JointVector& end() const { return joints_.back(); }

 private:
  void FitSpline();
  void SplineAt(int segment, double x, JointState& by_s) const;
  void Time(const std::vector<Eigen::Vector3d>& tool_m, const ArmLimits& limits,
            const PathLimits& path_limits);

  std::vector<JointVector> joints_;     // spline knots
  std::vector<JointVector> curvature_;  // second derivatives by s at the knots
  std::vector<double> grid_speed_;      // ds/dt at the timing grid, kGridPerSegment per knot
  std::vector<double> times_s_;         // time at the timing grid
};

}  // namespace gusset
