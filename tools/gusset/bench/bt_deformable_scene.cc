#include "tools/gusset/bench/bt_deformable_scene.h"

#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletSoftBody/btDeformableBodySolver.h>
#include <BulletSoftBody/btDeformableMultiBodyConstraintSolver.h>
#include <BulletSoftBody/btDeformableMultiBodyDynamicsWorld.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

#include "base/gravity.h"
#include "sim/hand_scene.h"

namespace gusset {
namespace {

constexpr double kSettle_s = 0.3;
constexpr double kStable_m_s = 3;
// Nodes so close to the grasp are held: six, of which none must carry all.
constexpr double kHeldRadius_m = 0.025;
// A 20 mm link that pulls with its spring alone would let the cloth crawl through a thin table.
constexpr double kTableDepth_m = 0.5;

btVector3 ToBullet(const Eigen::Vector3d& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

}  // namespace

struct BtDeformableDrag::Impl {
  Impl(const SimConfig& sim, const BtDeformableConfig& config)
      : stock(config),
        h(btScalar(1) / btScalar(config.steps_per_s)),
        mesh(MakeBagMesh(sim.bag)),
        dispatcher(&collision_config),
        world(&dispatcher, &broadphase, &constraint_solver, &collision_config, &solver),
        spring(btScalar(stock.spring_N_m), btScalar(stock.damping_Ns_m), true, stock.bending_N_m),
        gravity(btVector3(0, 0, btScalar(-kGravity_m_s2))),
        table_shape(btVector3(1, 1, btScalar(0.5 * kTableDepth_m))),
        cube_shape(btVector3(1, 1, 1) * btScalar(0.5 * sim.world.cube_side_m)),
        hand_shape(btScalar(0.002)) {
    constraint_solver.setDeformableSolver(&solver);
    world.setGravity(btVector3(0, 0, btScalar(-kGravity_m_s2)));
    world.getWorldInfo().m_gravity = world.getGravity();
    world.getWorldInfo().m_sparsesdf.setDefaultVoxelsz(0.25f);
    world.getWorldInfo().m_sparsesdf.Reset();
    world.setImplicit(false);
    world.setLineSearch(false);
    world.setUseProjection(true);

    table = std::make_unique<btRigidBody>(0, nullptr, &table_shape);
    table->setWorldTransform(
        btTransform(btQuaternion::getIdentity(), btVector3(0, 0, btScalar(-0.5 * kTableDepth_m))));
    // Bullet multiplies what both sides have.
    const double cloth_friction = std::sqrt(sim.bag.friction_cloth);
    table->setFriction(btScalar(sim.bag.friction_table / cloth_friction));
    world.addRigidBody(table.get());

    btVector3 inertia;
    cube_shape.calculateLocalInertia(btScalar(sim.world.cube_mass_kg), inertia);
    cube = std::make_unique<btRigidBody>(btScalar(sim.world.cube_mass_kg), nullptr, &cube_shape,
                                         inertia);
    cube->setWorldTransform(btTransform(
        btQuaternion::getIdentity(), ToBullet({sim.world.cube_wait_m[0], sim.world.cube_wait_m[1],
                                               0.5 * sim.world.cube_side_m})));
    cube->setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(cube.get());

    hand = std::make_unique<btRigidBody>(0, nullptr, &hand_shape);
    hand->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT |
                            btCollisionObject::CF_NO_CONTACT_RESPONSE);
    hand->setActivationState(DISABLE_DEACTIVATION);
    grasp = {0, -0.5 * sim.bag.depth_m + kHoldInset_m, 3 * stock.margin_m};
    PutHand(grasp);
    world.addRigidBody(hand.get(), 0, 0);
    LayBag(sim.bag);
  }

  ~Impl() {
    world.removeSoftBody(body.get());
    for (btRigidBody* rigid : {hand.get(), cube.get(), table.get()}) world.removeRigidBody(rigid);
  }

  // Layers start a little more than two margins apart: closer ones are flung apart.
  void LayBag(const BagConfig& bag) {
    std::vector<btVector3> x;
    const auto half_gap = btScalar(1.25 * stock.margin_m);
    std::vector<int> held;
    for (std::size_t i = 0; i < mesh.rest.size(); ++i) {
      const Vec3f& r = mesh.rest[i];
      const float side = r.z() > 0 ? 1.0f : r.z() < 0 ? -1.0f : 0.0f;
      const btVector3 p(r.x() - btScalar(0.5 * bag.opening_m), r.y() - btScalar(0.5 * bag.depth_m),
                        btScalar(1.25 * stock.margin_m) + half_gap * (1 + side));
      x.push_back(p);
      const double off = std::hypot(p.x() - grasp.x(), p.y() - grasp.y());
      if (side > 0 && off < kHeldRadius_m) held.push_back(static_cast<int>(i));
    }
    body = std::make_unique<btSoftBody>(&world.getWorldInfo(), mesh.node_count(), x.data(),
                                        mesh.mass_kg.data());
    for (const std::array<int, 2>& e : mesh.edges) body->appendLink(e[0], e[1]);
    for (const std::array<int, 3>& t : mesh.triangles) body->appendFace(t[0], t[1], t[2]);
    body->generateBendingConstraints(2);
    body->getCollisionShape()->setMargin(btScalar(stock.margin_m));
    body->m_cfg.kKHR = 1;
    body->m_cfg.kCHR = 1;
    body->m_cfg.kDF = btScalar(std::sqrt(bag.friction_cloth));
    body->m_cfg.collisions = btSoftBody::fCollision::SDF_RD | btSoftBody::fCollision::SDF_RDN |
                             btSoftBody::fCollision::VF_DD;
    body->setActivationState(DISABLE_DEACTIVATION);
    world.addSoftBody(body.get());
    body->setSelfCollision(true);
    world.addForce(body.get(), &spring);
    world.addForce(body.get(), &gravity);
    held_nodes = held;
  }

  void PutHand(const Eigen::Vector3d& p_W) {
    hand->setWorldTransform(btTransform(btQuaternion::getIdentity(), ToBullet(p_W)));
    at = p_W;
  }

  // @returns false once a node is too fast or nowhere.
  bool Move(const Eigen::Vector3d& way, double seconds) {
    const Eigen::Vector3d from = at;
    const long steps = std::lround(seconds / h);
    for (long i = 1; i <= steps; ++i) {
      PutHand(from + way * (static_cast<double>(i) / static_cast<double>(steps)));
      world.stepSimulation(h, 0);
      if (i % 8 == 0 && !Stable()) return false;
    }
    return Stable();
  }

  bool Stable() {
    btScalar most = 0;
    bool finite = true;
    for (int i = 0; i < body->m_nodes.size(); ++i) {
      const btSoftBody::Node& node = body->m_nodes[i];
      most = std::max(most, node.m_v.length2());
      finite = finite && std::isfinite(node.m_x.length2()) && std::isfinite(node.m_v.length2());
    }
    fastest = std::max(fastest, static_cast<double>(std::sqrt(most)));
    return finite && fastest < kStable_m_s;
  }

  BtDeformableConfig stock;
  btScalar h;
  ClothMesh mesh;
  btSoftBodyRigidBodyCollisionConfiguration collision_config;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btDeformableBodySolver solver;
  btDeformableMultiBodyConstraintSolver constraint_solver;
  btDeformableMultiBodyDynamicsWorld world;
  btDeformableMassSpringForce spring;
  btDeformableGravityForce gravity;
  btBoxShape table_shape, cube_shape;
  btSphereShape hand_shape;
  std::unique_ptr<btRigidBody> table, cube, hand;
  std::unique_ptr<btSoftBody> body;
  std::vector<int> held_nodes;
  Eigen::Vector3d grasp = Eigen::Vector3d::Zero(), at = Eigen::Vector3d::Zero();
  double fastest = 0;
  bool stable = true;
};

BtDeformableDrag::BtDeformableDrag(const SimConfig& config, const BtDeformableConfig& stock)
    : impl_(std::make_unique<Impl>(config, stock)) {
  impl_->stable = impl_->Move(Eigen::Vector3d::Zero(), kSettle_s);
  for (const int node : impl_->held_nodes) {
    impl_->body->appendDeformableAnchor(node, impl_->hand.get());
  }
  if (impl_->stable) {
    impl_->stable = impl_->Move({0, 0, kDragHeight_m}, kDragHeight_m / kDragSpeed_m_s);
  }
}

BtDeformableDrag::~BtDeformableDrag() = default;

bool BtDeformableDrag::Play() {
  if (impl_->stable) impl_->stable = impl_->Move({0, kDragWay_m, 0}, simulated_s());
  return impl_->stable;
}

double BtDeformableDrag::simulated_s() const { return kDragWay_m / kDragSpeed_m_s; }
double BtDeformableDrag::fastest_m_s() const { return impl_->fastest; }

double BtDeformableDrag::max_stretch() const {
  double most = 0;
  for (const ClothLink& link : impl_->mesh.stretch) {
    const auto& nodes = impl_->body->m_nodes;
    most = std::max<double>(most, (nodes[link.a].m_x - nodes[link.b].m_x).length() / link.rest_m);
  }
  return most;
}

Vec3Array BtDeformableDrag::nodes() const {
  Vec3Array x;
  for (int i = 0; i < impl_->body->m_nodes.size(); ++i) {
    const btVector3& p = impl_->body->m_nodes[i].m_x;
    x.emplace_back(p.x(), p.y(), p.z());
  }
  return x;
}

}  // namespace gusset
