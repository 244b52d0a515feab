#include "sim/starts.h"

#include <cmath>
#include <numbers>

#include "base/error.h"
#include "base/random.h"
#include "base/stop.h"
#include "sim/top_view.h"

namespace gusset {
namespace {

constexpr int kMostAttempts = 300;
constexpr float kDropHeight_m = 0.30f;
constexpr double kFoldTime_s = 0.7;
constexpr double kSettle_s = 0.5;
constexpr double kMostRest_s = 4.0;
constexpr float kRestSpeed_m_s = 0.003f;  // root mean square
constexpr float kGathered = 0.25f;        // what a hand leaves of the width that it closes round
constexpr float kGatherTime_s = 0.5f;
constexpr float kHandForce_N = 60.0f;  // two hands hold faster than a gripper
// While it comes to rest, a bag's area changes by less than 1 % and few labels turn up or vanish
// (40 starts, 2026-11): what is further from serving is not waited for.
constexpr double kAreaSlack = 1.03;
constexpr int kLabelSlack = 1;
constexpr std::array<int, 4> kWholeView = {0, 0, 640, 480};

/// A pair of hands over a table: holds cloth, moves it, pushes it.
class Hands {
 public:
  Hands(Cloth& cloth, double h) : cloth_(cloth), h_(static_cast<float>(h)) {}

  template <class Motion>
  void Move(double seconds, Motion motion) {
    const long steps = std::lround(seconds / h_);
    for (long i = 1; i <= steps; ++i) {
      ThrowIfStopped();
      motion(static_cast<float>(i) / static_cast<float>(steps));
      cloth_.Predict(h_);
      cloth_.SolveConstraints(h_, X_WT, shapes);
      for (RigidShape& s : shapes) s.X_WS_prev = s.X_WS;
    }
  }
  void Wait(double seconds) {
    Move(seconds, [](float) {});
  }
  float steps_per_s() const { return 1.0f / h_; }
  void Rest() {
    for (double t = 0; t < kMostRest_s && cloth_.RmsSpeed() > kRestSpeed_m_s; t += 0.1) Wait(0.1);
  }

  Eigen::Isometry3f X_WT = Eigen::Isometry3f::Identity();
  std::vector<RigidShape> shapes;

 private:
  Cloth& cloth_;
  float h_;
};

Vec3f Mean(const Vec3Array& x) {
  Vec3f sum = Vec3f::Zero();
  for (const Vec3f& p : x) sum += p;
  return sum / static_cast<float>(x.size());
}

// Flat on the table with the mouth towards -y before yaw; one of the two sides up.
void LayFlat(Cloth& cloth, const BagConfig& bag, double yaw, bool other_side, const Vec3f& centre) {
  ClothState s = cloth.state();
  s.x = cloth.mesh().rest;
  const Eigen::AngleAxisf turn(static_cast<float>(yaw), Vec3f::UnitZ());
  const Vec3f middle(static_cast<float>(0.5 * bag.opening_m), static_cast<float>(0.5 * bag.depth_m),
                     0);
  const float lift = static_cast<float>(bag.thickness_m) + 0.0005f;
  for (Vec3f& p : s.x) {
    p -= middle;
    if (other_side) p = Vec3f(-p.x(), p.y(), -p.z());
    p = turn * p + centre;
    p.z() += lift;
  }
  s.v.assign(s.x.size(), Vec3f::Zero());
  s.bend_set.clear();
  s.stretch_set.clear();
  s.shear_set.clear();
  cloth.SetState(std::move(s));
}

// Lifts the far strip of the smaller side of a line over to the other side, like a page.
void Fold(Cloth& cloth, Hands& hands, Rng& rng) {
  const double theta = rng.Uniform(0, 2 * std::numbers::pi);
  const double offset = rng.Uniform(-0.03, 0.03);
  const Vec3f normal(static_cast<float>(std::cos(theta)), static_cast<float>(std::sin(theta)), 0);
  const Vec3f along(-normal.y(), normal.x(), 0);
  Vec3f on_line = Mean(cloth.state().x) + normal * static_cast<float>(offset);
  float most = 0, least = 0, top = 0;
  for (const Vec3f& p : cloth.state().x) {
    most = std::max(most, normal.dot(p - on_line));
    least = std::min(least, normal.dot(p - on_line));
    top = std::max(top, p.z());
  }
  const float side = most <= -least ? 1.0f : -1.0f;
  const float reach = std::min(most, -least);
  if (reach < 0.02f) return;
  // The hands hold all plies within the outer fifth of the flap.
  const Vec3f out = side * normal;
  PadGap gap;
  gap.X_WT.linear().col(0) = out;
  gap.X_WT.linear().col(2) = Vec3f(0, 0, -1);
  gap.X_WT.linear().col(1) = gap.X_WT.linear().col(2).cross(out);
  gap.X_WT.translation() = on_line + out * (0.9f * reach);
  gap.X_WT.translation().z() = 0;
  gap.opening_m = 0.2f * reach;
  gap.half_width_m = 0.25f;
  gap.height_m = top + 0.01f;
  hands.X_WT = gap.X_WT;
  cloth.BeginHold(gap, kHandForce_N);
  // The page turns about a line above the plies it will lie on.
  Eigen::Isometry3f X_WAxis = Eigen::Isometry3f::Identity();
  on_line.z() = top + 0.004f;
  X_WAxis.translation() = on_line;
  const Eigen::Isometry3f start = gap.X_WT;
  const Vec3f axis = out.cross(Vec3f::UnitZ());
  hands.Move(kFoldTime_s, [&](float s) {
    const float smooth = s * s * (3 - 2 * s);
    const float angle = -smooth * 170.0f * std::numbers::pi_v<float> / 180.0f;
    const Eigen::Isometry3f turn = X_WAxis * Eigen::AngleAxisf(-angle, axis) * X_WAxis.inverse();
    hands.X_WT = turn * start;
  });
  cloth.EndHold();
  hands.Wait(kSettle_s);
}

// A hand closes round a random point, which gathers the cloth there, lifts it to kDropHeight_m
// above the table, and lets go.
void Drop(Cloth& cloth, Hands& hands, Rng& rng) {
  const int node = rng.Below(cloth.mesh().node_count());
  const Vec3f p = cloth.state().x[node];
  const float hand = static_cast<float>(rng.Uniform(0.03, 0.06));
  PadGap gap;
  gap.X_WT.linear() << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  gap.X_WT.translation() << p.x(), p.y(), 0;
  gap.opening_m = 2 * hand;
  gap.half_width_m = hand;
  gap.height_m = 0.08f;
  hands.X_WT = gap.X_WT;
  cloth.BeginHold(gap, kHandForce_N);
  const Vec3f from = gap.X_WT.translation();
  const Vec3f to(0, 0, kDropHeight_m);
  const float per_step = std::pow(kGathered, 1.0f / (kGatherTime_s * hands.steps_per_s()));
  hands.Move(kGatherTime_s, [&](float s) {
    cloth.GatherHold(per_step);
    hands.X_WT.translation() = from + Vec3f(0, 0, 0.05f * s);
  });
  const Vec3f up = hands.X_WT.translation();
  hands.Move(0.7, [&](float s) {
    const float smooth = s * s * (3 - 2 * s);
    hands.X_WT.translation() = up * (1 - smooth) + to * smooth;
  });
  cloth.EndHold();
  hands.Wait(kSettle_s);
}

// Two flat hands push the bag together from opposite sides, leave upwards, and do it again across.
void Push(Cloth& cloth, Hands& hands, Rng& rng) {
  const double theta = rng.Uniform(0, std::numbers::pi);
  const float stop = static_cast<float>(rng.Uniform(0.05, 0.07));
  for (int turn = 0; turn < 2; ++turn) {
    const Vec3f mean = Mean(cloth.state().x);
    for (int k = 0; k < 2; ++k) {
      RigidShape hand;
      hand.half = Vec3f(0.01f, 0.15f, 0.05f);
      hand.friction = 0.4f;
      hand.X_WS.linear() =
          Eigen::AngleAxisf(static_cast<float>(theta + (k + 0.5 * turn) * std::numbers::pi),
                            Vec3f::UnitZ())
              .toRotationMatrix();
      hands.shapes.push_back(hand);
    }
    const auto place = [&](float distance, float height) {
      for (RigidShape& hand : hands.shapes) {
        hand.X_WS.translation() =
            Vec3f(mean.x(), mean.y(), height) + hand.X_WS.linear() * Vec3f(distance, 0, 0);
      }
    };
    place(0.25f, 0.0505f);
    for (RigidShape& hand : hands.shapes) hand.X_WS_prev = hand.X_WS;
    hands.Move(0.6, [&](float s) { place(0.25f + (stop - 0.25f) * s, 0.0505f); });
    hands.Move(0.2, [&](float s) { place(stop + 0.03f * s, 0.0505f + 0.25f * s); });
    hands.shapes.clear();
  }
  hands.Wait(kSettle_s);
}

void MoveCentre(Cloth& cloth, const Vec3f& centre) {
  ClothState s = cloth.state();
  Vec3f shift = centre - Mean(s.x);
  shift.z() = 0;
  for (Vec3f& p : s.x) p += shift;
  s.v.assign(s.x.size(), Vec3f::Zero());
  cloth.SetState(std::move(s));
}

Vec3f RandomCentre(const StartConfig& config, bool any_pose, Rng& rng) {
  const double radius =
      (any_pose ? config.any_centre_m : config.centre_m) * std::sqrt(rng.Uniform());
  const double angle = rng.Uniform(0, 2 * std::numbers::pi);
  return {static_cast<float>(radius * std::cos(angle)),
          static_cast<float>(radius * std::sin(angle)), 0};
}

// True if the mouth is hidden and the area within bounds, give or take some labels and a factor.
bool Serves(const Cloth& cloth, const std::vector<LabelPatch>& labels, const CameraModel& camera,
            const StartConfig& config, int more_labels, double more_area, int& area_px) {
  const TopView view = LookAtBag(cloth.mesh(), cloth.state().x, labels, camera, kWholeView);
  int seen = 0;
  for (const int px : view.label_px) seen += px >= config.label_seen_px;
  area_px = view.bag_px;
  return seen < config.mouth_labels + more_labels &&
         area_px >= config.folded_area_min_px / more_area &&
         area_px <= config.folded_area_max_px * more_area;
}

}  // namespace

Start MakeFoldedStart(const BagConfig& bag, const ClothSolverConfig& solver,
                      const StartConfig& config, const CameraModel& camera, bool any_pose,
                      std::uint64_t seed) {
  Cloth cloth(MakeBagMesh(bag), bag, solver);
  const std::vector<LabelPatch> labels = MakeLabels(bag);
  Rng kind_rng(DeriveSeed(seed, "fold kind"));
  Start start;
  start.kind = static_cast<FoldKind>(kind_rng.Below(3));
  for (start.attempts = 1; start.attempts <= kMostAttempts; ++start.attempts) {
    Rng rng(DeriveSeed(seed, "fold attempt", static_cast<std::uint64_t>(start.attempts)));
    const double yaw = rng.Uniform(0, 2 * std::numbers::pi);
    const bool other_side = rng.Below(2) == 1;
    // Folds begin with a flat bag; a bag that was dropped is picked up again as it lies: laid flat
    // every 4, 8 or 16 drops it takes more of them (docs/performance.md).
    if (start.kind == FoldKind::kFolds || start.attempts == 1) {
      LayFlat(cloth, bag, yaw, other_side, Vec3f::Zero());
    }
    Hands hands(cloth, 1.0 / solver.substeps_per_s);
    if (start.kind == FoldKind::kFolds) {
      const int folds = 2 + rng.Below(2);
      for (int k = 0; k < folds; ++k) Fold(cloth, hands, rng);
    } else {
      Drop(cloth, hands, rng);
      if (start.kind == FoldKind::kPush) Push(cloth, hands, rng);
    }
    // What is far from serving now will not serve once it is at rest.
    if (!Serves(cloth, labels, camera, config, kLabelSlack, kAreaSlack, start.area_px)) continue;
    hands.Rest();
    MoveCentre(cloth, RandomCentre(config, any_pose, rng));
    if (Serves(cloth, labels, camera, config, 0, 1, start.area_px)) {
      start.cloth = cloth.state();
      return start;
    }
  }
  throw RunError("bag '" + bag.name + "': no folded start in " + std::to_string(kMostAttempts) +
                 " attempts covers starts.folded_area_min_px .. folded_area_max_px");
}

Start MakeUnfoldedStart(const BagConfig& bag, const ClothSolverConfig& solver,
                        const StartConfig& config, const CameraModel& camera, bool any_pose,
                        std::uint64_t seed) {
  Cloth cloth(MakeBagMesh(bag), bag, solver);
  Rng rng(DeriveSeed(seed, "unfolded"));
  const double spread = config.yaw_deg * std::numbers::pi / 180;
  const double yaw = any_pose ? rng.Uniform(0, 2 * std::numbers::pi) : rng.Uniform(-spread, spread);
  const bool other_side = rng.Below(2) == 1;
  const Vec3f centre = RandomCentre(config, any_pose, rng);
  LayFlat(cloth, bag, yaw, other_side, centre);
  Hands hands(cloth, 1.0 / solver.substeps_per_s);
  hands.Wait(0.3);
  hands.Rest();
  Start start;
  start.cloth = cloth.state();
  start.area_px =
      LookAtBag(cloth.mesh(), start.cloth.x, MakeLabels(bag), camera, kWholeView).bag_px;
  return start;
}

}  // namespace gusset
