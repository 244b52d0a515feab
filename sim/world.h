#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/cloth/cloth.h"
#include "sim/robot/arm_environment.h"
#include "sim/robot/arm_model.h"
#include "sim/world_config.h"

namespace gusset {

/// A rigid body's motion; SI, world frame.
struct BodyState {
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();
  Eigen::Vector3d v_m_s = Eigen::Vector3d::Zero();
  Eigen::Vector3d w_rad_s = Eigen::Vector3d::Zero();
};

/// Everything a world needs to go on as it was.
struct WorldState {
  double time_s = 0;
  ClothState cloth;
  BodyState cube;
  bool cube_held = false;
  Eigen::Isometry3d X_TCube = Eigen::Isometry3d::Identity();  ///< While held.
  double hold_force_N = 0;
  double rest_s = 0;        ///< How long everything has been at rest; 0 unless asleep.
  double held_clear_s = 0;  ///< See Truth.
};

/// The cube where it waits: on the table at cube_wait_m, square to the world's axes, at rest.
BodyState WaitingCube(const WorldConfig& config);

/// Table, bag, cube and the arm's links in Bullet. The bag is a btSoftBody whose nodes are moved by
/// Cloth through Bullet's own extension point, btSoftBodySolver; cube, table and kinematic arm
/// links are Bullet's, as is contact between them.
///
/// Bullet's solver keeps warm-start impulses and pair orders that cannot be saved, so a world is
/// never rewound: a state is restored by building a new World from it.
class World : public ArmEnvironment {
 public:
  /// @param arm must outlive the world.
  World(const BagConfig& bag, const ClothSolverConfig& solver, const WorldConfig& config,
        const ArmModel& arm);
  ~World() override;

  /// Puts bag and cube there. Once, before the first step.
  void SetState(const WorldState& state);
  /// The arm's links and fingers as they are now, without moving them there.
  void PlaceArm(const std::vector<Eigen::Isometry3d>& X_WL, double finger_opening_m);
  WorldState state() const;

  double step_s() const override;
  void Step(const std::vector<Eigen::Isometry3d>& X_WL, double finger_opening_m,
            bool at_rest) override;
  Eigen::Vector3d ForceOnTool() const override;
  double PadForce() const override;
  bool PadsBlocked() const override;
  void BeginHold(double force_N) override;
  void EndHold() override;

  /// Lets time pass with the arm where it is.
  void Settle(double seconds);
  const Cloth& cloth() const;
  Cloth& cloth();  ///< For starts and tests.
  BodyState cube() const;
  void SetCube(const BodyState& cube);
  const WorldConfig& config() const;
  double time_s() const;
  bool asleep() const;
  bool cube_held() const;
  /// True if `p_W` lies inside the bag: generalised winding number above one half (Jacobson,
  /// Kavan, Sorkine-Hornung 2013).
  bool InsideBag(const Eigen::Vector3d& p_W) const;
  /// Lowest point of bag and cube above the table, m.
  double LowestPoint() const;
  double held_clear_s() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace gusset
