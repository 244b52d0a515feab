#pragma once

#include <Eigen/Geometry>
#include <optional>
#include <vector>

#include "sim/robot/arm_model.h"
#include "sim/robot/ik.h"
#include "sim/robot/trajectory.h"

namespace gusset {

/// Trajectories to be run one after the other, each from rest to rest.
using Motion = std::vector<Trajectory>;

/// Finds motions that keep the joint limits, stay clear of the camera body and of the cylinder
/// round the base, and never jump. Holds scratch space: one per thread. `arm` must outlive it.
class MotionPlanner {
 public:
  explicit MotionPlanner(const ArmModel& arm);

  /// The tool on a straight line from q to X_WT, orientation interpolated along (slerp). ~1 ms
  /// for 0.3 m.
  std::optional<Trajectory> Line(const JointVector& q, const Eigen::Isometry3d& X_WT,
                                 double speed_m_s);
  /// Straight in joint space. Fingertips stay above the lower of both ends, floor_m at most.
  std::optional<Trajectory> Joints(const JointVector& q, const JointVector& q_end, double speed_m_s,
                                   double floor_m) const;

  /// A line to X_WT or, since the gripper is symmetric, to X_WT turned by half a turn about the
  /// approach axis, whichever needs less turning. Where neither is possible the tool is tilted
  /// radially about its tip, by as little as possible and at most max_tilt_deg.
  std::optional<Trajectory> LineWithTolerance(const JointVector& q, const Eigen::Isometry3d& X_WT,
                                              double speed_m_s);
  /// A line or, where there is none, a detour: straight up to free_height_m (if below it), through
  /// joint space to the goal or to the config's gate and from there on a line, straight down.
  /// Joint-space parts keep 0.8 free_height_m. A goal between half and all of free_height_m, above
  /// which nothing is reachable, is come to on a slant. Tolerances as for LineWithTolerance; an arm
  /// that starts at free_height_m or above takes a detour rather than tilt. ~5 ms with a detour.
  std::optional<Motion> To(const JointVector& q, const Eigen::Isometry3d& X_WT, double speed_m_s);
  /// Through joint space to the waiting configuration or, where the camera is in the way, to the
  /// gate first; before that a straight lift, or a move away from the base, if there is no other
  /// way. In joint space the fingertips never sink below where they start.
  std::optional<Motion> ToWaiting(const JointVector& q);

  /// Joints for X_WT under To's tolerances, clear of the camera.
  std::optional<JointVector> Reach(const Eigen::Isometry3d& X_WT, const JointVector& near);

 private:
  /// X_WT as asked, flipped, and tilted more and more; the less turning of a pair first.
  std::vector<Eigen::Isometry3d> Variants(const Eigen::Isometry3d& X_WT,
                                          const Eigen::Isometry3d& X_WTool) const;
  /// How many of the first variants are not tilted.
  std::size_t upright_variants() const { return arm_.has_gripper() ? 2 : 1; }
  bool CrossesBase(const Eigen::Vector3d& p_W0, const Eigen::Vector3d& p_W1) const;
  std::optional<Motion> Across(const JointVector& q, const Eigen::Isometry3d& X_WT,
                               double speed_m_s);
  std::optional<Motion> Home(const JointVector& q, double floor_m);
  std::optional<Motion> Detour(const JointVector& q, const Eigen::Isometry3d& X_WT,
                               double speed_m_s);
  std::optional<Trajectory> Timed(const std::vector<JointVector>& joints, double speed_m_s,
                                  double floor_m) const;

  const ArmModel& arm_;
  IkSolver ik_;
};

}  // namespace gusset
