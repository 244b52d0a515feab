#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/gravity.h"
#include "sim/cloth/bag_config.h"
#include "sim/cloth/bag_mesh.h"
#include "sim/cloth/bend_solver.h"
#include "sim/cloth/cloth_types.h"
#include "sim/cloth/link_solver.h"
#include "sim/cloth/rigid_contact.h"
#include "sim/cloth/self_contact.h"
#include "sim/cloth/yarn_solver.h"

namespace gusset {

/// Cloth held between a gripper's pads: a material point bound to a place in the tool frame.
struct HeldPoint {
  std::array<int, 3> node{};
  Vec3f weight = Vec3f::Zero();  ///< Barycentric.
  Vec3f p_T = Vec3f::Zero();
  float share = 0;  ///< Of the hold's force limit.
  int layer = 0;
};

/// Everything about a cloth that a snapshot must keep.
struct ClothState {
  Vec3Array x;  ///< m, world.
  Vec3Array v;  ///< m/s.
  /// What internal friction holds to: per bend the second difference (m), per lane of the link
  /// solvers the elongation (m). Empty: as the cloth lies, no link longer or shorter.
  std::vector<float> bend_set, stretch_set, shear_set;
  std::vector<HeldPoint> held;
  std::vector<float> tether_m;  ///< Per node: longest distance to tether_to; empty: no hold.
  std::vector<int> tether_to;   ///< Per node: index into held.
  float hold_limit_N = 0;
  float pad_half_width_m = 0;  ///< Of the pads that hold; what slips past their edges is lost.
  float pad_height_m = 0;
};

/// The volume between a gripper's pads, in the tool frame: |x| <= opening/2,
/// |y| <= half_width, -height <= z <= 0.
struct PadGap {
  Eigen::Isometry3f X_WT = Eigen::Isometry3f::Identity();
  float opening_m = 0;
  float half_width_m = 0.011f;
  float height_m = 0.0375f;
};

/// A cloth stepped by extended position-based dynamics in small substeps (Macklin, Mueller,
/// Chentanez 2016; Macklin et al. 2019): bending and air as forces, yarns as constraints, contact
/// with itself, a table at z = 0 and rigid shapes, a gripper's hold with a force limit.
class Cloth {
 public:
  Cloth(ClothMesh mesh, const BagConfig& bag, const ClothSolverConfig& solver);
  Cloth(const Cloth&) = delete;

  const ClothMesh& mesh() const { return mesh_; }
  const ClothState& state() const { return state_; }
  /// Puts the cloth somewhere; the contact search starts afresh.
  void SetState(ClothState state);

  /// Forces and free motion over h seconds.
  void Predict(float h);
  /// Constraints and contact; ends the substep. X_WT: the tool at its end.
  void SolveConstraints(float h, const Eigen::Isometry3f& X_WT, std::vector<RigidShape>& shapes);

  /// Binds what lies between the pads to the tool, with a force limit shared by area.
  void BeginHold(const PadGap& gap, float limit_N);
  void EndHold();
  /// Draws what is held together towards the tool's z axis by this factor, as a closing hand does.
  void GatherHold(float factor);
  bool holding() const { return !state_.held.empty(); }
  /// Thickest stack of cloth between the pads (m), were it pressed together.
  float StackBetween(const PadGap& gap) const;
  /// Force of the cloth on the tool through the hold in the last substep (N).
  const Vec3f& hold_force_N() const { return hold_force_N_; }

  /// Whether cloth may be within distance_m of the shape: boxes in the shape's own axes around each
  /// triangle and around the shape are that close. Never false for cloth that is.
  bool IsNear(const RigidShape& shape, float distance_m) const;

  float MaxSpeed() const;
  /// Root mean square over all nodes, m/s.
  float RmsSpeed() const;
  /// Largest stretch ratio of the yarns now, and the node where it is.
  float MaxStretch(int* where = nullptr) const;
  const SelfContact& contact() const { return contact_; }
  Vec3f gravity_m_s2{0, 0,
                     static_cast<float>(-kGravity_m_s2)};  ///< World; tilting it tilts the table.

 private:
  Vec3f At(std::size_t node) const { return x_[node].head<3>(); }
  Vec3f At(const HeldPoint& held) const;
  void MeasureAir();
  void ApplyAir(float h);
  void SolveLinks(float h, int iteration);
  void SolveTable();
  void SolveHold(float h, const Eigen::Isometry3f& X_WT);
  void YieldHold(const Vec3Array& wanted, float most_m, const Eigen::Isometry3f& X_WT);
  void LoseWhatSlippedOut();
  void MeasureTethers();
  void ListBeside(const std::vector<RigidShape>& shapes);
  void Tether(float h, const Eigen::Isometry3f& X_WT);

  ClothMesh mesh_;
  BagConfig bag_;
  ClothSolverConfig solver_;
  ClothState state_;          ///< As of the last substep's end.
  Vec4Array x_, x_prev_, v_;  ///< Of the substep under way.
  std::vector<float> inv_mass_;
  LinkSolver stretch_, shear_;
  YarnSolver yarns_;
  BendSolver bends_;
  std::vector<YarnSolver::Group> beside_;  ///< Yarns at what is held, and near rigid bodies.
  int since_air_ = 0;
  Vec4Array air_;  ///< Force of the air per node, N.
  SelfContact contact_;
  RigidContact rigid_contact_;
  float buckling_friction_N_, shear_friction_N_;  // of one link
  Vec3f hold_force_N_ = Vec3f::Zero();
  // What the hold gave in the substep under way, N: each point, and through tethers in all.
  Vec3Array held_N_;
  float tethered_N_ = 0;
};

}  // namespace gusset
