#include "sim/cloth/bullet_cloth.h"

namespace gusset {

BulletClothSolver::BulletClothSolver(Cloth& cloth, std::function<void(float)> solve)
    : cloth_(cloth), solve_(std::move(solve)) {}

std::unique_ptr<btSoftBody> BulletClothSolver::MakeSoftBody(btSoftBodyWorldInfo& info) const {
  const ClothMesh& mesh = cloth_.mesh();
  btAlignedObjectArray<btVector3> x;
  btAlignedObjectArray<btScalar> mass;
  for (int i = 0; i < mesh.node_count(); ++i) {
    const Vec3f& p = cloth_.state().x[i];
    x.push_back(btVector3(p.x(), p.y(), p.z()));
    mass.push_back(mesh.mass_kg[i]);
  }
  auto body = std::make_unique<btSoftBody>(&info, mesh.node_count(), &x[0], &mass[0]);
  for (const auto& e : mesh.edges) body->appendLink(e[0], e[1]);
  for (const auto& t : mesh.triangles) body->appendFace(t[0], t[1], t[2]);
  // Contact is Cloth's; Bullet's own handler is called for every soft body unless told not to.
  body->m_cfg.collisions = 0;
  body->getCollisionShape()->setMargin(0.5f * mesh.thickness_m);
  return body;
}

void BulletClothSolver::optimize(btAlignedObjectArray<btSoftBody*>& bodies, bool) {
  body_ = bodies.size() > 0 ? bodies[0] : nullptr;
}

void BulletClothSolver::updateSoftBodies() {
  if (!body_) return;
  const ClothState& state = cloth_.state();
  btVector3 lo(1e9f, 1e9f, 1e9f), hi(-1e9f, -1e9f, -1e9f);
  for (int i = 0; i < body_->m_nodes.size(); ++i) {
    btSoftBody::Node& node = body_->m_nodes[i];
    node.m_q = node.m_x;
    node.m_x.setValue(state.x[i].x(), state.x[i].y(), state.x[i].z());
    node.m_v.setValue(state.v[i].x(), state.v[i].y(), state.v[i].z());
    lo.setMin(node.m_x);
    hi.setMax(node.m_x);
  }
  body_->m_bounds[0] = lo;
  body_->m_bounds[1] = hi;
}

}  // namespace gusset
