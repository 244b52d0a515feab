#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "sim/sim_scene.h"

namespace gusset {

/// Two layers laid flat over the table's centre, a hair above it, mouth towards -y.
ClothState LaidFlat(const BagConfig& bag);

/// All links waiting far away but the hand's, which points down with the fingertips at p_W.
std::vector<Eigen::Isometry3d> HandAt(const ArmModel& arm, const Eigen::Vector3d& p_W,
                                      double opening_m);

/// A bag, the cube and a hand that goes where it is told, without an arm to carry it: fixed scenes
/// that tests and benchmarks share.
class HandScene {
 public:
  /// The hand high above the table, fingers wide open.
  /// @param arm must outlive the scene.
  HandScene(const SimConfig& config, const ArmModel& arm, const WorldState& start);

  /// Puts the hand there, from one step to the next.
  void Put(const Eigen::Vector3d& p_W, double opening_m);
  /// Moves the hand along a straight way at a constant speed; `after_step` is called after each.
  void Move(const Eigen::Vector3d& way_m, double speed_m_s,
            const std::function<void()>& after_step = {});
  World& world() { return world_; }
  const Eigen::Vector3d& p_W() const { return p_W_; }  ///< Of the fingertips.

 private:
  const ArmModel& arm_;
  World world_;
  Eigen::Vector3d p_W_ = Eigen::Vector3d::Zero();
  double opening_m_ = 0;
};

/// A scene up to where its motion begins, and that motion.
struct ReadyScene {
  std::unique_ptr<HandScene> hand;
  Eigen::Vector3d way_m = Eigen::Vector3d::Zero();
  double speed_m_s = 0;

  void Play(const std::function<void()>& after_step = {}) const {
    hand->Move(way_m, speed_m_s, after_step);
  }
};

/// How far inside the rim, in its middle, the hand takes hold.
inline constexpr double kHoldInset_m = 0.02;
/// How wide the pads are apart when they do.
inline constexpr double kHoldOpening_m = 0.01;
/// How high a drag lifts the lip first.
inline constexpr double kDragHeight_m = 0.01;
inline constexpr double kDragWay_m = 0.15;
inline constexpr double kDragSpeed_m_s = 0.1;
inline constexpr double kCarryWay_m = 0.5;
inline constexpr double kCarrySpeed_m_s = 0.25;

/// Drag: the bag lies flat, its upper layer is held near the rim and about to be drawn over the
/// lower one, towards the bottom.
ReadyScene MakeDragScene(const SimConfig& config, const ArmModel& arm);

/// Carry: the cube hangs in the bag, both layers of which are held near the rim, high enough above
/// the table to be carried sideways.
ReadyScene MakeCarryScene(const SimConfig& config, const ArmModel& arm);

}  // namespace gusset
