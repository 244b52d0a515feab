#include "sim/world.h"

#include <BulletCollision/CollisionDispatch/btDefaultCollisionConfiguration.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletSoftBody/btSoftBodyRigidBodyCollisionConfiguration.h>
#include <BulletSoftBody/btSoftRigidDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <optional>

#include "base/error.h"
#include "base/gravity.h"
#include "base/stop.h"
#include "sim/cloth/bullet_cloth.h"
#include "sim/pedestal.h"

namespace gusset {
namespace {

// Force readings are averaged over this time, as an arm's own filter does.
constexpr double kForceWindow_s = 0.02;
// Of table, canvas and fingertips together; tuned to stop a guarded move within a tenth of a mm.
constexpr double kTableStiffness_N_m = 3e4;
// The cube is as firm, with critical damping at 40 g. Bullet's rigid contact has no stiffness of
// its own: what a link presses down onto the table would be felt by how far the solver came.
// Both are each of a face's four contact points'.
constexpr double kCubeStiffness_N_m = kTableStiffness_N_m / 4;
constexpr double kCubeDamping_N_s_m = 70.0 / 4;
constexpr float kShapeMargin_m = 0.0005f;
// Cloth is felt between the pads when, pressed together, it would fill this share of the gap.
constexpr double kFullGap = 0.9;
// A link pressed onto the table with more than this keeps the world awake, which feels it.
constexpr double kPressing_N = 0.1;
// Looking for it costs as much as a substep; a finger moves 0.25 mm in so many steps at 50 mm/s.
constexpr int kStackEvery = 3;
// An awake world is checked for runaway speeds this often.
constexpr int kCheckEvery = 8;
// Episode success asks for this height (docs/loop.md).
constexpr double kClear_m = 0.15;
constexpr int kClearEvery = 24;

template <class T>
T Mean(const std::vector<T>& ring) {
  return std::accumulate(ring.begin() + 1, ring.end(), ring.front()) /
         static_cast<double>(ring.size());
}

btTransform ToBullet(const Eigen::Isometry3d& X) {
  const Eigen::Matrix3d& R = X.linear();
  return btTransform(btMatrix3x3(btScalar(R(0, 0)), btScalar(R(0, 1)), btScalar(R(0, 2)),
                                 btScalar(R(1, 0)), btScalar(R(1, 1)), btScalar(R(1, 2)),
                                 btScalar(R(2, 0)), btScalar(R(2, 1)), btScalar(R(2, 2))),
                     btVector3(btScalar(X.translation().x()), btScalar(X.translation().y()),
                               btScalar(X.translation().z())));
}

Eigen::Isometry3d FromBullet(const btTransform& t) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) X.linear()(r, c) = t.getBasis()[r][c];
    X.translation()[r] = t.getOrigin()[r];
  }
  return X;
}

Eigen::Vector3d FromBullet(const btVector3& v) { return {v.x(), v.y(), v.z()}; }
btVector3 ToBullet(const Eigen::Vector3d& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

/// A convex primitive of a link: in Bullet for the cube, in `shapes` for the cloth.
struct LinkShape {
  int link;
  Eigen::Isometry3d X_LS;
  std::unique_ptr<btConvexShape> bullet_shape;
  std::unique_ptr<btRigidBody> body;
};

}  // namespace

struct World::Impl {
  Impl(const BagConfig& bag, const ClothSolverConfig& solver, const WorldConfig& world_config,
       const ArmModel& arm_model)
      : config(world_config),
        arm(arm_model),
        h(1.0 / solver.substeps_per_s),
        max_speed(solver.max_speed_m_s),
        cloth(MakeBagMesh(bag), bag, solver),
        cloth_solver(cloth, [this](float dt) { SolveCloth(dt); }) {
    dispatcher = std::make_unique<btCollisionDispatcher>(&collision_config);
    world = std::make_unique<btSoftRigidDynamicsWorld>(dispatcher.get(), &broadphase, &rigid_solver,
                                                       &collision_config, &cloth_solver);
    world->setGravity(btVector3(0, 0, btScalar(-kGravity_m_s2)));
    world->getWorldInfo().m_gravity = world->getGravity();
    // The table: a thick slab, so that nothing ends up beneath it.
    table_shape = std::make_unique<btBoxShape>(btVector3(2, 2, 0.5f));
    table_shape->setMargin(kShapeMargin_m);
    table = std::make_unique<btRigidBody>(0, nullptr, table_shape.get());
    table->setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, -0.5f)));
    table->setFriction(1);
    world->addRigidBody(table.get());
    floor_shape = std::make_unique<btBoxShape>(btVector3(20, 20, 0.5f));
    floor = std::make_unique<btRigidBody>(0, nullptr, floor_shape.get());
    floor->setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, -1.25f)));
    floor->setFriction(1);
    world->addRigidBody(floor.get());

    const Pedestal block;
    pedestal_shape = std::make_unique<btBoxShape>(ToBullet(0.5 * block.size_m));
    pedestal_shape->setMargin(kShapeMargin_m);
    pedestal = std::make_unique<btRigidBody>(0, nullptr, pedestal_shape.get());
    pedestal->setWorldTransform(btTransform(btQuaternion::getIdentity(), ToBullet(block.centre_m)));
    pedestal->setFriction(1);
    world->addRigidBody(pedestal.get());

    const btScalar half = btScalar(0.5 * config.cube_side_m);
    cube_shape = std::make_unique<btBoxShape>(btVector3(half, half, half));
    cube_shape->setMargin(kShapeMargin_m);
    btVector3 inertia;
    cube_shape->calculateLocalInertia(btScalar(config.cube_mass_kg), inertia);
    cube = std::make_unique<btRigidBody>(btScalar(config.cube_mass_kg), nullptr, cube_shape.get(),
                                         inertia);
    // Bullet multiplies the friction of both bodies; table and fingers have 1.
    cube->setFriction(btScalar(config.cube_friction));
    // Contact with cloth does not wake a body that Bullet put to sleep; World has its own rest.
    cube->setActivationState(DISABLE_DEACTIVATION);
    cube->setDamping(0.05f, 0.2f);
    cube->setContactStiffnessAndDamping(btScalar(kCubeStiffness_N_m), btScalar(kCubeDamping_N_s_m));
    world->addRigidBody(cube.get());

    RigidShape cube_rigid;
    cube_rigid.half = Vec3f::Constant(half);
    cube_rigid.friction = static_cast<float>(bag.friction_cube);
    shapes.push_back(cube_rigid);

    for (std::size_t l = 0; l < arm.robot().links().size(); ++l) {
      for (const CollisionShape& c : arm.robot().links()[l].collisions) AddLinkShape(int(l), c);
    }
    RigidShape pedestal_rigid;
    pedestal_rigid.half = (0.5 * block.size_m).cast<float>();
    pedestal_rigid.friction = static_cast<float>(bag.friction_table);
    pedestal_rigid.X_WS.translation() = block.centre_m.cast<float>();
    pedestal_rigid.X_WS_prev = pedestal_rigid.X_WS;
    shapes.push_back(pedestal_rigid);
    X_WL.assign(arm.robot().links().size(), Eigen::Isometry3d::Identity());
    anchor_shape = std::make_unique<btSphereShape>(0.001f);
    anchor = std::make_unique<btRigidBody>(0, nullptr, anchor_shape.get());
    anchor->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT |
                              btCollisionObject::CF_NO_CONTACT_RESPONSE);
    anchor->setActivationState(DISABLE_DEACTIVATION);
    world->addRigidBody(anchor.get(), 0, 0);

    soft_body = cloth_solver.MakeSoftBody(world->getWorldInfo());
    world->addSoftBody(soft_body.get(), 0, 0);  // its contacts are Cloth's
    force_ring.assign(std::max<std::size_t>(1, std::size_t(std::lround(kForceWindow_s / h))),
                      Eigen::Vector3d::Zero());
    pad_ring.assign(force_ring.size(), 0.0);
    cube_ring.assign(force_ring.size(), Eigen::Vector3d::Zero());
    tip_link = *arm.robot().FindLink(arm.config().tip_link);
  }

  ~Impl() {
    DropCube();
    world->removeSoftBody(soft_body.get());
    world->removeRigidBody(anchor.get());
    for (LinkShape& l : links) world->removeRigidBody(l.body.get());
    world->removeRigidBody(cube.get());
    world->removeRigidBody(pedestal.get());
    world->removeRigidBody(floor.get());
    world->removeRigidBody(table.get());
  }

  void AddLinkShape(int link, const CollisionShape& c) {
    LinkShape l;
    l.link = link;
    l.X_LS = c.X_LS;
    RigidShape rigid;
    rigid.friction = static_cast<float>(config.pad_friction);
    const btVector3 size = ToBullet(c.size_m);
    switch (c.kind) {
      case CollisionShape::Kind::kBox:
        l.bullet_shape = std::make_unique<btBoxShape>(size * 0.5f);
        rigid.kind = RigidShape::Kind::kBox;
        rigid.half = (0.5 * c.size_m).cast<float>();
        break;
      case CollisionShape::Kind::kSphere:
        l.bullet_shape = std::make_unique<btSphereShape>(size.x());
        rigid.kind = RigidShape::Kind::kSphere;
        rigid.half = Vec3f::Constant(size.x());
        break;
      case CollisionShape::Kind::kCylinder:
        l.bullet_shape =
            std::make_unique<btCylinderShapeZ>(btVector3(size.x(), size.x(), 0.5f * size.z()));
        rigid.kind = RigidShape::Kind::kCylinder;
        rigid.half = Vec3f(size.x(), size.x(), 0.5f * size.z());
        break;
    }
    if (c.kind != CollisionShape::Kind::kSphere) l.bullet_shape->setMargin(kShapeMargin_m);
    l.body = std::make_unique<btRigidBody>(0, nullptr, l.bullet_shape.get());
    l.body->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    l.body->setActivationState(DISABLE_DEACTIVATION);
    l.body->setFriction(1);
    // Links meet the cube alone: not each other, not the table they stand on.
    world->addRigidBody(l.body.get(), btBroadphaseProxy::KinematicFilter,
                        btBroadphaseProxy::DefaultFilter);
    if (arm.has_gripper() && link == arm.finger_link_a()) finger_a.push_back(shapes.size());
    if (arm.has_gripper() && link == arm.finger_link_b()) finger_b.push_back(shapes.size());
    shapes.push_back(rigid);
    links.push_back(std::move(l));
  }

  void MoveLinks(const std::vector<Eigen::Isometry3d>& X_WL_now, bool jump) {
    X_WL = X_WL_now;
    for (std::size_t i = 0; i < links.size(); ++i) {
      const Eigen::Isometry3d X_WS = X_WL[links[i].link] * links[i].X_LS;
      RigidShape& shape = shapes[i + 1];
      shape.X_WS_prev = jump ? X_WS.cast<float>() : shape.X_WS;
      shape.X_WS = X_WS.cast<float>();
      links[i].body->setWorldTransform(ToBullet(X_WS));
      if (jump) links[i].body->setInterpolationWorldTransform(ToBullet(X_WS));
    }
    X_WT = X_WL[tip_link];
    anchor->setWorldTransform(ToBullet(X_WT));
    if (jump) anchor->setInterpolationWorldTransform(ToBullet(X_WT));
  }

  void SolveCloth(float dt) {
    RigidShape& c = shapes[0];
    c.X_WS_prev = cube_before;
    c.X_WS = FromBullet(cube->getWorldTransform()).cast<float>();
    // In the grip the cube is as firm as the arm. Were it as light as it is, cloth caught beneath
    // it would push it out of the pads faster than the joint can bring it back.
    c.inv_mass = cube_hold ? 0.0f : static_cast<float>(1 / config.cube_mass_kg);
    const btMatrix3x3& I = cube->getInvInertiaTensorWorld();
    for (int r = 0; r < 3; ++r) {
      for (int k = 0; k < 3; ++k) c.inv_inertia_W(r, k) = I[r][k];
    }
    cloth.SolveConstraints(dt, X_WT.cast<float>(), shapes);
    if (!cube_hold && (c.impulse != Vec3f::Zero() || c.angular_impulse != Vec3f::Zero())) {
      const Eigen::Quaternionf q(c.X_WS.linear());
      const Eigen::Quaternionf n = q.normalized();
      btTransform t;
      t.setOrigin(
          btVector3(c.X_WS.translation().x(), c.X_WS.translation().y(), c.X_WS.translation().z()));
      t.setRotation(btQuaternion(n.x(), n.y(), n.z(), n.w()));
      cube->setWorldTransform(t);
      cube->applyCentralImpulse(btVector3(c.impulse.x(), c.impulse.y(), c.impulse.z()));
      cube->applyTorqueImpulse(
          btVector3(c.angular_impulse.x(), c.angular_impulse.y(), c.angular_impulse.z()));
    }
  }

  PadGap Gap() const {
    PadGap gap;
    gap.X_WT = X_WT.cast<float>();
    gap.opening_m = static_cast<float>(opening);
    gap.half_width_m = static_cast<float>(0.5 * config.pad_width_m);
    gap.height_m = static_cast<float>(config.pad_height_m);
    return gap;
  }

  // The cube is between the pads and as wide as their gap.
  bool CubeBetweenPads() const {
    const Eigen::Isometry3d X_TC = X_WT.inverse() * FromBullet(cube->getWorldTransform());
    const double half = 0.5 * config.cube_side_m;
    const Eigen::Vector3d extent = half * X_TC.linear().cwiseAbs() * Eigen::Vector3d::Ones();
    const Eigen::Vector3d p = X_TC.translation();
    return std::abs(p.x()) < half && std::abs(p.y()) < 0.5 * config.pad_width_m + half &&
           p.z() - extent.z() < 0 && p.z() + extent.z() > -config.pad_height_m &&
           2 * extent.x() + 0.0004 >= opening;
  }

  // Whether the cube passes through the fingers, as it must where they hold it.
  void IgnoreFingers(bool ignore) {
    for (const std::vector<std::size_t>* finger : {&finger_a, &finger_b}) {
      for (const std::size_t s : *finger) {
        cube->setIgnoreCollisionCheck(links[s - 1].body.get(), ignore);
      }
    }
    // Bullet would keep solving the contacts that it has found before.
    world->getPairCache()->cleanProxyFromPairs(cube->getBroadphaseHandle(), world->getDispatcher());
  }

  void GrabCube(const Eigen::Isometry3d& X_TC) {
    DropCube();
    // Frames in body A (the tool) and B (the cube): all six degrees of freedom locked.
    cube_hold = std::make_unique<btGeneric6DofSpring2Constraint>(*anchor, *cube, ToBullet(X_TC),
                                                                 btTransform::getIdentity());
    for (int axis = 0; axis < 6; ++axis) cube_hold->setLimit(axis, 0, 0);
    world->addConstraint(cube_hold.get(), true);
    X_TCube = X_TC;
    std::ranges::fill(cube_ring, Eigen::Vector3d::Zero());
    // Inside the grip there is nothing for the fingers to collide with.
    IgnoreFingers(true);
  }

  void DropCube() {
    if (!cube_hold) return;
    world->removeConstraint(cube_hold.get());
    cube_hold.reset();
    IgnoreFingers(false);
  }

  // The tool's locked joint tells how hard it pulls; beyond what the pads' friction gives, the cube
  // slips. A mean, since cloth and joint pass impulses to and fro from step to step.
  void CheckCubeHold() {
    if (!cube_hold) return;
    cube_ring[steps % cube_ring.size()] = CubeForce();
    if (Mean(cube_ring).norm() > 2 * config.pad_friction * hold_force) DropCube();
  }

  Eigen::Vector3d CubeForce() const {
    if (!cube_hold) return Eigen::Vector3d::Zero();
    // What the cube's motion in this step needed beyond gravity, cloth and contact.
    const Eigen::Vector3d dv = FromBullet(cube->getLinearVelocity()) - cube_velocity_before;
    const Eigen::Vector3d from_cloth =
        shapes[0].impulse.cast<double>() / h + shapes[0].squeeze.cast<double>();
    return from_cloth + on_cube -
           config.cube_mass_kg * (dv / h + Eigen::Vector3d(0, 0, kGravity_m_s2));
  }

  // Forces of Bullet's contacts with the cube in the step that has been taken.
  void ReadContacts() {
    on_cube = on_links = Eigen::Vector3d::Zero();
    for (int m = 0; m < dispatcher->getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(m);
      const bool first = manifold.getBody0() == cube.get();
      if (!first && manifold.getBody1() != cube.get()) continue;
      btVector3 impulse(0, 0, 0);  // on the first body
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        impulse += point.m_appliedImpulse * point.m_normalWorldOnB +
                   point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                   point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
      }
      const Eigen::Vector3d force = FromBullet(first ? impulse : -impulse) / h;
      on_cube += force;
      const btCollisionObject& other = first ? *manifold.getBody1() : *manifold.getBody0();
      if (other.isKinematicObject()) on_links -= force;
    }
  }

  // A link that is driven into the table feels it as a stiff spring.
  double TableForce(const RigidShape& shape) const {
    const float reach = (shape.X_WS.linear().cwiseAbs() * shape.half).z();
    const float depth = reach - shape.X_WS.translation().z();
    return depth > 0 ? kTableStiffness_N_m * depth : 0.0;
  }

  // Whether a link presses on the table, or may touch cloth or cube in the next substep.
  bool SomethingNear() const {
    const auto& x = cloth.state().x;
    if (bounds_stale) {
      bounds_lo = bounds_hi = x.front();
      for (const Vec3f& p : x) {
        bounds_lo = bounds_lo.cwiseMin(p);
        bounds_hi = bounds_hi.cwiseMax(p);
      }
      bounds_stale = false;
    }
    const Vec3f near = Vec3f::Constant(static_cast<float>(config.wake_distance_m));
    const Vec3f lo = bounds_lo - near, hi = bounds_hi + near;
    const Vec3f cube_p = shapes[0].X_WS.translation();
    const Vec3f cube_r =
        Vec3f::Constant(static_cast<float>(0.87 * config.cube_side_m + config.wake_distance_m));
    for (std::size_t s = 1; s <= links.size(); ++s) {
      const Vec3f p = shapes[s].X_WS.translation();
      const Vec3f r = shapes[s].X_WS.linear().cwiseAbs() * shapes[s].half;
      const bool in_bounds =
          ((p + r).array() > lo.array()).all() && ((p - r).array() < hi.array()).all();
      const bool cube_near = ((p + r).array() > (cube_p - cube_r).array()).all() &&
                             ((p - r).array() < (cube_p + cube_r).array()).all();
      if (cube_near || TableForce(shapes[s]) > kPressing_N ||
          (in_bounds && cloth.IsNear(shapes[s], near.x()))) {
        return true;
      }
    }
    return false;
  }

  // Whether the arm, at rest or moving, leaves cloth and cube alone.
  bool LeavesThingsAlone(bool at_rest) const {
    return at_rest || !(cloth.holding() || cube_hold || SomethingNear());
  }

  // Asleep once nothing has gone anywhere for a while. Nodes that contact throws to and fro on the
  // spot are at rest.
  void FallAsleep(bool at_rest) {
    const Vec3Array& x = cloth.state().x;
    const auto near_start = [&] {
      float sum = 0;
      for (std::size_t i = 0; i < x.size(); ++i) sum += (x[i] - rest_from[i]).squaredNorm();
      return std::sqrt(sum / static_cast<float>(x.size())) <
             config.rest_speed_m_s * config.rest_time_s;
    };
    const bool rests = rest_from.size() == x.size() && near_start() &&
                       FromBullet(cube->getLinearVelocity()).norm() < config.rest_speed_m_s &&
                       LeavesThingsAlone(at_rest);
    rest = rests ? rest + h : 0;
    if (rest == 0) rest_from = x;
    if (rest < config.rest_time_s) return;
    Check();
    asleep = true;
  }

  void Check() const {
    const float speed = cloth.MaxSpeed();
    const Eigen::Vector3d p = FromBullet(cube->getWorldTransform().getOrigin());
    if (speed <= max_speed && p.allFinite() && p.norm() < 10) return;
    char text[256];
    std::snprintf(text, sizeof text,
                  "world stopped at %.4f s simulated: fastest cloth node %g m/s (bound: "
                  "solver.max_speed_m_s = %g), cube at (%g, %g, %g) m",
                  time, double(speed), max_speed, p.x(), p.y(), p.z());
    throw RunError(text);
  }

  WorldConfig config;
  const ArmModel& arm;
  double h;
  double max_speed;
  Cloth cloth;
  BulletClothSolver cloth_solver;
  btSoftBodyRigidBodyCollisionConfiguration collision_config;
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver rigid_solver;
  std::unique_ptr<btCollisionDispatcher> dispatcher;
  std::unique_ptr<btSoftRigidDynamicsWorld> world;
  std::unique_ptr<btBoxShape> table_shape, floor_shape, pedestal_shape, cube_shape;
  std::unique_ptr<btSphereShape> anchor_shape;
  std::unique_ptr<btRigidBody> table, floor, pedestal, cube, anchor;
  std::unique_ptr<btSoftBody> soft_body;
  std::unique_ptr<btGeneric6DofSpring2Constraint> cube_hold;
  std::vector<LinkShape> links;
  std::vector<RigidShape> shapes;  // the cube, the links' in the order of `links`, the pedestal
  std::vector<std::size_t> finger_a, finger_b;
  std::vector<Eigen::Isometry3d> X_WL;
  int tip_link = 0;
  Eigen::Isometry3d X_WT = Eigen::Isometry3d::Identity();
  Eigen::Isometry3d X_TCube = Eigen::Isometry3d::Identity();
  Eigen::Isometry3f cube_before = Eigen::Isometry3f::Identity();
  Eigen::Vector3d cube_velocity_before = Eigen::Vector3d::Zero();
  Eigen::Vector3d on_cube = Eigen::Vector3d::Zero();   // N, of Bullet's contacts
  Eigen::Vector3d on_links = Eigen::Vector3d::Zero();  // N, of those with the cube
  double opening = 0;
  double hold_force = 0;
  double time = 0;
  double rest = 0;
  Vec3Array rest_from;  // where nodes were when `rest` was last 0
  double held_clear = 0;
  bool clear = false;  // the bag is held, the cube inside, both high enough
  bool asleep = false;
  long steps = 0;
  std::vector<Eigen::Vector3d> force_ring;
  std::vector<Eigen::Vector3d> cube_ring;
  std::vector<double> pad_ring;
  mutable double stack = 0;
  mutable long stack_step = -1000;
  mutable bool bounds_stale = true;
  mutable Vec3f bounds_lo = Vec3f::Zero(), bounds_hi = Vec3f::Zero();
};

BodyState WaitingCube(const WorldConfig& config) {
  BodyState cube;
  cube.X_WB.translation() << config.cube_wait_m[0], config.cube_wait_m[1], 0.5 * config.cube_side_m;
  return cube;
}

World::World(const BagConfig& bag, const ClothSolverConfig& solver, const WorldConfig& config,
             const ArmModel& arm)
    : impl_(std::make_unique<Impl>(bag, solver, config, arm)) {
  SetCube(WaitingCube(config));
}

World::~World() = default;

void World::SetState(const WorldState& state) {
  impl_->time = state.time_s;
  impl_->cloth.SetState(state.cloth);
  impl_->bounds_stale = true;
  SetCube(state.cube);
  impl_->hold_force = state.hold_force_N;
  // How far nodes have moved in a rest that had but begun is not known.
  impl_->asleep = impl_->config.rest_speed_m_s > 0 && state.rest_s >= impl_->config.rest_time_s;
  impl_->rest = impl_->asleep ? state.rest_s : 0;
  impl_->rest_from.clear();
  impl_->held_clear = state.held_clear_s;
  impl_->clear = state.held_clear_s > 0;
  if (state.cube_held) impl_->GrabCube(state.X_TCube);
  impl_->cloth_solver.updateSoftBodies();
}

void World::PlaceArm(const std::vector<Eigen::Isometry3d>& X_WL, double finger_opening_m) {
  impl_->opening = finger_opening_m;
  impl_->MoveLinks(X_WL, true);
}

WorldState World::state() const {
  WorldState s;
  s.time_s = impl_->time;
  s.cloth = impl_->cloth.state();
  s.cube = cube();
  s.cube_held = cube_held();
  s.X_TCube = impl_->X_TCube;
  s.hold_force_N = impl_->hold_force;
  s.rest_s = impl_->asleep ? impl_->rest : 0;
  s.held_clear_s = impl_->held_clear;
  return s;
}

double World::step_s() const { return impl_->h; }

void World::Step(const std::vector<Eigen::Isometry3d>& X_WL, double finger_opening_m,
                 bool at_rest) {
  ThrowIfStopped();
  Impl& w = *impl_;
  ++w.steps;
  w.time += w.h;
  w.opening = finger_opening_m;
  w.MoveLinks(X_WL, false);
  if (w.asleep && w.LeavesThingsAlone(at_rest)) {
    if (w.clear) w.held_clear += w.h;
    w.force_ring[w.steps % w.force_ring.size()] =
        w.force_ring[(w.steps + w.force_ring.size() - 1) % w.force_ring.size()];
    return;
  }
  if (w.asleep) w.rest = 0;
  w.asleep = false;
  w.bounds_stale = true;
  w.cube_before = FromBullet(w.cube->getWorldTransform()).cast<float>();
  w.cube_velocity_before = FromBullet(w.cube->getLinearVelocity());
  w.world->stepSimulation(btScalar(w.h), 0);
  w.shapes[0].X_WS = FromBullet(w.cube->getWorldTransform()).cast<float>();
  w.ReadContacts();

  Eigen::Vector3d force = w.cloth.hold_force_N().cast<double>() + w.CubeForce() + w.on_links;
  for (std::size_t s = 1; s <= w.links.size(); ++s) {
    const RigidShape& shape = w.shapes[s];
    force += shape.impulse.cast<double>() / w.h + shape.squeeze.cast<double>();
    force.z() += w.TableForce(shape);
  }
  double pads[2] = {0, 0};
  for (const std::size_t s : w.finger_a) pads[0] += w.shapes[s].squeeze_minus_x;
  for (const std::size_t s : w.finger_b) pads[1] += w.shapes[s].squeeze_minus_x;
  w.force_ring[w.steps % w.force_ring.size()] = force;
  w.pad_ring[w.steps % w.pad_ring.size()] = std::min(pads[0], pads[1]);
  w.CheckCubeHold();

  if (!w.cloth.holding()) w.clear = false;
  if (w.steps % kClearEvery == 0) {
    w.clear = w.cloth.holding() && LowestPoint() >= kClear_m &&
              InsideBag(FromBullet(w.cube->getWorldTransform().getOrigin()));
  }
  w.held_clear = w.clear ? w.held_clear + w.h : 0;
  if (w.steps % kCheckEvery == 0) w.Check();
  w.FallAsleep(at_rest);
}

void World::Settle(double seconds) {
  const long steps = std::lround(seconds / impl_->h);
  const std::vector<Eigen::Isometry3d> X_WL = impl_->X_WL;
  for (long i = 0; i < steps; ++i) Step(X_WL, impl_->opening, true);
}

Eigen::Vector3d World::ForceOnTool() const { return Mean(impl_->force_ring); }

double World::PadForce() const { return Mean(impl_->pad_ring); }

bool World::PadsBlocked() const {
  if (impl_->CubeBetweenPads()) return true;
  if (impl_->steps - impl_->stack_step >= kStackEvery) {
    impl_->stack = impl_->cloth.StackBetween(impl_->Gap());
    impl_->stack_step = impl_->steps;
  }
  return impl_->stack > kFullGap * impl_->opening;
}

void World::BeginHold(double force_N) {
  impl_->hold_force = force_N;
  impl_->asleep = false;
  impl_->rest = 0;
  impl_->cloth.BeginHold(impl_->Gap(),
                         static_cast<float>(2 * impl_->config.pad_friction * force_N));
  if (impl_->CubeBetweenPads()) {
    impl_->GrabCube(impl_->X_WT.inverse() * FromBullet(impl_->cube->getWorldTransform()));
  }
}

void World::EndHold() {
  impl_->cloth.EndHold();
  impl_->DropCube();
  impl_->asleep = false;
  impl_->rest = 0;
}

const Cloth& World::cloth() const { return impl_->cloth; }
Cloth& World::cloth() { return impl_->cloth; }

BodyState World::cube() const {
  BodyState s;
  s.X_WB = FromBullet(impl_->cube->getWorldTransform());
  s.v_m_s = FromBullet(impl_->cube->getLinearVelocity());
  s.w_rad_s = FromBullet(impl_->cube->getAngularVelocity());
  return s;
}

void World::SetCube(const BodyState& cube) {
  btRigidBody& body = *impl_->cube;
  body.setWorldTransform(ToBullet(cube.X_WB));
  body.setInterpolationWorldTransform(ToBullet(cube.X_WB));
  body.setLinearVelocity(ToBullet(cube.v_m_s));
  body.setAngularVelocity(ToBullet(cube.w_rad_s));
  body.updateInertiaTensor();
  impl_->shapes[0].X_WS = impl_->shapes[0].X_WS_prev = cube.X_WB.cast<float>();
}

const WorldConfig& World::config() const { return impl_->config; }
double World::time_s() const { return impl_->time; }
bool World::asleep() const { return impl_->asleep; }
bool World::cube_held() const { return impl_->cube_hold != nullptr; }
double World::held_clear_s() const { return impl_->held_clear; }

bool World::InsideBag(const Eigen::Vector3d& p_W) const {
  const ClothMesh& mesh = impl_->cloth.mesh();
  const auto& x = impl_->cloth.state().x;
  const Vec3f p = p_W.cast<float>();
  double solid_angle = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& n = mesh.triangles[t];
    // Solid angle of a triangle (Van Oosterom and Strackee 1983).
    const Vec3f a = x[n[0]] - p, b = x[n[1]] - p, c = x[n[2]] - p;
    const float la = a.norm(), lb = b.norm(), lc = c.norm();
    const float det = a.dot(b.cross(c));
    const float den = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    const double angle = 2 * std::atan2(det, den);
    // Both layers wind alike as seen from above; the lower one faces inwards.
    solid_angle += mesh.triangle_layer[t] == 0 ? -angle : angle;
  }
  return std::abs(solid_angle) > 2 * std::numbers::pi;
}

double World::LowestPoint() const {
  float low = impl_->cloth.state().x.front().z();
  for (const Vec3f& p : impl_->cloth.state().x) low = std::min(low, p.z());
  low -= 0.5f * impl_->cloth.mesh().thickness_m;
  const Eigen::Isometry3d X = FromBullet(impl_->cube->getWorldTransform());
  const double reach = 0.5 * impl_->config.cube_side_m * X.linear().row(2).cwiseAbs().sum();
  return std::min<double>(low, X.translation().z() - reach);
}

}  // namespace gusset
