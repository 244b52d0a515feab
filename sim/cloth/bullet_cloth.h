#pragma once

#include <BulletSoftBody/btSoftBody.h>
#include <BulletSoftBody/btSoftBodySolvers.h>

#include <functional>
#include <memory>

#include "sim/cloth/cloth.h"

namespace gusset {

/// Steps a Cloth where Bullet steps its soft bodies (btSoftBodySolver, Bullet's extension point),
/// and keeps a btSoftBody's nodes where the cloth's are.
class BulletClothSolver : public btSoftBodySolver {
 public:
  /// `solve` is called once per Bullet step, after Bullet has moved the rigid bodies.
  BulletClothSolver(Cloth& cloth, std::function<void(float)> solve);

  /// A soft body with the cloth's nodes and faces, for adding to a btSoftRigidDynamicsWorld.
  std::unique_ptr<btSoftBody> MakeSoftBody(btSoftBodyWorldInfo& info) const;

  SolverTypes getSolverType() const override { return CPU_SOLVER; }
  bool checkInitialized() override { return true; }
  void optimize(btAlignedObjectArray<btSoftBody*>& bodies, bool) override;
  void copyBackToSoftBodies(bool) override {}
  void predictMotion(btScalar h) override { cloth_.Predict(h); }
  void solveConstraints(btScalar h) override { solve_(h); }
  void updateSoftBodies() override;
  void processCollision(btSoftBody*, const btCollisionObjectWrapper*) override {}
  void processCollision(btSoftBody*, btSoftBody*) override {}

 private:
  Cloth& cloth_;
  std::function<void(float)> solve_;
  btSoftBody* body_ = nullptr;
};

}  // namespace gusset
