#pragma once

#include <memory>

#include "sim/sim_scene.h"

namespace gusset {

/// Bullet's own cloth as the benchmark runs it.
struct BtDeformableConfig {
  /// The inverse of the largest step at which the drag is stable (`Play`): 2026-11, in steps of
  /// 10 a second. Contact order differs from run to run: 140, 160, 170, 200 and 210 blew up at
  /// least once, 150, 180 and 190 did not in the one run each had, 220 and 230 held in three of
  /// three and 240, 250 and 500 in one.
  int steps_per_s = 220;
  double spring_N_m = 20;  ///< Per link, k. The larger, the smaller the step must be.
  double bending_N_m = 1;  ///< Per link over two edges. With k too, as in Bullet's examples, the
                           ///< bag is a plate: it slides as a whole and no layer moves on another.
  double damping_Ns_m = 0.1;  ///< Per link.
  double margin_m = 0.00075;  ///< Of the cloth's contact: half of Bag 1's thickness.
};

/// The same bag (nodes, triangles, masses) and the same drag as MakeDragScene, by Bullet's own
/// solver for deformable bodies: btDeformableMultiBodyDynamicsWorld with btDeformableBodySolver,
/// explicit, with projection (setUseProjection), self-collision on. Table and cube are there; of
/// the hand only what holds: a kinematic body to which the nodes beside the grasp are anchored. Air
/// is left out. All of that makes it faster than it would be with what our side steps.
class BtDeformableDrag {
 public:
  /// The bag on the table, its lip lifted: ready to be dragged.
  BtDeformableDrag(const SimConfig& config, const BtDeformableConfig& stock);
  ~BtDeformableDrag();
  BtDeformableDrag(const BtDeformableDrag&) = delete;

  /// The drag. @returns true if it was stable: no node faster than 3 m/s (thirty times the hand),
  /// each coordinate finite.
  bool Play();
  double simulated_s() const;  ///< In Play.
  double fastest_m_s() const;  ///< Node, at any time so far.
  double max_stretch() const;  ///< Of a link along the yarns, now.
  Vec3Array nodes() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gusset
