#include "sim/hand_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gusset {
namespace {

constexpr double kGrip_N = 60;     // as MotionConfig::grip_force_N
constexpr double kSettle_s = 0.5;  // a bag laid down comes to rest in half of that
constexpr double kHigh_m = 0.6;    // the hand is far from everything
constexpr double kSwing_s = 0.5;   // after the lift
constexpr double kLift_m = 0.5;    // a bag 0.35 m deep is then 0.15 m clear
constexpr double kLift_m_s = 0.25;
constexpr float kHair_m = 0.0005f;

// Where the cube lies in the bag, from its middle towards the bottom.
constexpr float kCubeTowardsBottom_m = 0.05f;
// The upper layer covers it with a level top and a slope so wide that no yarn is 10 % longer.
constexpr float kTopRadius_m = 0.03f;
constexpr float kSlope_m = 0.11f;

WorldState FlatBag(const SimConfig& config) {
  WorldState state;
  state.cloth = LaidFlat(config.bag);
  state.cube = WaitingCube(config.world);
  return state;
}

// A flat bag with the cube in it.
WorldState FilledBag(const SimConfig& config) {
  WorldState state = FlatBag(config);
  const ClothMesh mesh = MakeBagMesh(config.bag);
  const auto side = static_cast<float>(config.world.cube_side_m);
  Vec3Array& x = state.cloth.x;
  float lower = x.front().z(), upper = lower;
  for (const Vec3f& p : x) {
    lower = std::min(lower, p.z());
    upper = std::max(upper, p.z());
  }
  const float bottom = lower + 0.5f * mesh.thickness_m + kHair_m;
  const float top = bottom + side + kHair_m + 0.5f * mesh.thickness_m;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (mesh.rest[i].z() <= 0) continue;  // the lower layer and the seams
    const float r = std::hypot(x[i].x(), x[i].y() - kCubeTowardsBottom_m);
    const float down = std::clamp((r - kTopRadius_m) / kSlope_m, 0.0f, 1.0f);
    x[i].z() += (top - upper) * 0.5f * (1 + std::cos(static_cast<float>(std::numbers::pi) * down));
  }
  state.cube.X_WB.translation() = Eigen::Vector3d(0, kCubeTowardsBottom_m, bottom + 0.5f * side);
  return state;
}

Eigen::Vector3d AtTheRim(const BagConfig& bag, double tip_height_m) {
  return {0, -0.5 * bag.depth_m + kHoldInset_m, tip_height_m};
}

}  // namespace

ClothState LaidFlat(const BagConfig& bag) {
  ClothState cloth;
  for (Vec3f p : MakeBagMesh(bag).rest) {
    p -= Vec3f(static_cast<float>(0.5 * bag.opening_m), static_cast<float>(0.5 * bag.depth_m), 0);
    p.z() += static_cast<float>(bag.thickness_m) + kHair_m;
    cloth.x.push_back(p);
  }
  cloth.v.assign(cloth.x.size(), Vec3f::Zero());
  return cloth;
}

std::vector<Eigen::Isometry3d> HandAt(const ArmModel& arm, const Eigen::Vector3d& p_W,
                                      double opening_m) {
  std::vector<Eigen::Isometry3d> X_WL;
  arm.LinkPoses(arm.waiting(), opening_m, X_WL);
  const int tip = *arm.robot().FindLink(arm.config().tip_link);
  Eigen::Isometry3d X_WTip = Eigen::Isometry3d::Identity();
  X_WTip.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  X_WTip.translation() = p_W;
  const Eigen::Isometry3d move = X_WTip * X_WL[tip].inverse();
  for (const int finger : {arm.finger_link_a(), arm.finger_link_b()}) {
    X_WL[finger] = move * X_WL[finger];
  }
  X_WL[tip] = X_WTip;
  return X_WL;
}

HandScene::HandScene(const SimConfig& config, const ArmModel& arm, const WorldState& start)
    : arm_(arm), world_(config.bag, config.solver, config.world, arm) {
  world_.SetState(start);
  Put({0, 0, kHigh_m}, arm.max_opening_m());
}

void HandScene::Put(const Eigen::Vector3d& p_W, double opening_m) {
  p_W_ = p_W;
  opening_m_ = opening_m;
  world_.PlaceArm(HandAt(arm_, p_W, opening_m), opening_m);
}

void HandScene::Move(const Eigen::Vector3d& way_m, double speed_m_s,
                     const std::function<void()>& after_step) {
  const Eigen::Vector3d from = p_W_;
  const long steps = std::lround(way_m.norm() / speed_m_s / world_.step_s());
  for (long i = 1; i <= steps; ++i) {
    p_W_ = from + way_m * (static_cast<double>(i) / static_cast<double>(steps));
    world_.Step(HandAt(arm_, p_W_, opening_m_), opening_m_, false);
    if (after_step) after_step();
  }
}

ReadyScene MakeDragScene(const SimConfig& config, const ArmModel& arm) {
  ReadyScene scene;
  scene.hand = std::make_unique<HandScene>(config, arm, FlatBag(config));
  scene.hand->world().Settle(kSettle_s);
  // Fingertips one thickness above the table: between the layers' middles.
  scene.hand->Put(AtTheRim(config.bag, config.bag.thickness_m), kHoldOpening_m);
  scene.hand->world().BeginHold(kGrip_N);
  scene.hand->Move({0, 0, kDragHeight_m}, kDragSpeed_m_s);
  scene.way_m = {0, kDragWay_m, 0};
  scene.speed_m_s = kDragSpeed_m_s;
  return scene;
}

ReadyScene MakeCarryScene(const SimConfig& config, const ArmModel& arm) {
  ReadyScene scene;
  scene.hand = std::make_unique<HandScene>(config, arm, FilledBag(config));
  scene.hand->world().Settle(kSettle_s);
  scene.hand->Put(AtTheRim(config.bag, 0), kHoldOpening_m);
  scene.hand->world().BeginHold(kGrip_N);
  scene.hand->Move({0, 0, kLift_m}, kLift_m_s);
  scene.hand->world().Settle(kSwing_s);
  scene.way_m = {kCarryWay_m, 0, 0};
  scene.speed_m_s = kCarrySpeed_m_s;
  return scene;
}

}  // namespace gusset
