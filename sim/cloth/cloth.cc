#include "sim/cloth/cloth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>

namespace gusset {
namespace {

constexpr float kAirDensity_kg_m3 = 1.2f;  // dry air at 20 C and sea level
// A link gives this much before its internal friction slips; tuned, 2026-11: a fifth of what the
// tightest fold leaves of a link.
constexpr float kLinkSlip_m = 5e-4f;
constexpr int kAirEvery = 4;  // substeps between evaluations of the air's force
// Warps load wefts and these them; tuned 2026-11: with one, seams of a drawn bag end 11 % too long,
// with two 6 % (ClothInActions).
constexpr int kYarnPasses = 2;
// More sweeps beside fingers and cube; tuned 2026-11 (HangFromYarnsThatHardlyStretch,
// SleepingBagAndCube): yarns beside a hanging cube end 13, 8 and 6 % too long with 2, 3 and 4, but
// with 4 the bag that it hangs in does not come to rest.
constexpr int kBesideSweeps = 3;
// Woven cotton's yarns straighten by about a percent before they bear; tethers
// allow for it.
constexpr float kTetherSlack = 1.01f;
// Thicknesses that pads give before what they hold slips; tuned 2026-11: from 0.8 to 1.6 a bag with
// the cube hangs the same, at 0.6 a layer creeps to and fro in the pads (SleepingBagAndCube).
constexpr float kPadGives = 1.0f;
// Points per triangle side when cloth between the pads is looked for: 20 mm / 8
// = 2.5 mm apart.
constexpr int kHoldSamples = 8;

std::vector<float> Inverse(const std::vector<float>& mass) {
  std::vector<float> inverse;
  for (const float m : mass) inverse.push_back(1.0f / m);
  return inverse;
}

Float4 Load(const Vec4f& v) { return Float4::Load(v.data()); }

void Add(Vec4f& to, Float4 what) { (Load(to) + what).Store(to.data()); }

Vec4Array Widen(const Vec3Array& a) {
  Vec4Array wide;
  for (const Vec3f& p : a) wide.emplace_back(p.x(), p.y(), p.z(), 0.0f);
  return wide;
}

}  // namespace

Cloth::Cloth(ClothMesh mesh, const BagConfig& bag, const ClothSolverConfig& solver)
    : mesh_(std::move(mesh)),
      bag_(bag),
      solver_(solver),
      inv_mass_(Inverse(mesh_.mass_kg)),
      stretch_(mesh_.stretch, inv_mass_),
      shear_(mesh_.shear, inv_mass_),
      yarns_(mesh_.yarns, inv_mass_),
      bends_(mesh_.bends, inv_mass_, 1.0f / static_cast<float>(solver.substeps_per_s),
             static_cast<float>(solver.bend_damping_s)),
      contact_(mesh_, static_cast<float>(bag.friction_cloth)),
      rigid_contact_(mesh_, static_cast<float>(bag.opening_m * bag.depth_m * mesh_.layers),
                     static_cast<float>(solver.separation_speed_m_s)),
      // A link that buckles folds about its middle: the moment that friction holds there, B kappa
      // w, needs the force 2 B kappa w / L along it when it lies folded; links are as wide as long.
      buckling_friction_N_(
          static_cast<float>(2 * bag.flexural_rigidity_Nm * bag.residual_curvature_1_m)),
      shear_friction_N_(
          static_cast<float>(bag.shear_hysteresis_N_m * bag.opening_m / (bag.nodes_across - 1))) {
  ClothState flat;
  flat.x = mesh_.rest;
  flat.v.assign(mesh_.rest.size(), Vec3f::Zero());
  SetState(std::move(flat));
  air_.assign(mesh_.rest.size(), Vec4f::Zero());
}

void Cloth::SetState(ClothState state) {
  state_ = std::move(state);
  if (state_.bend_set.empty()) {
    for (const ClothBend& b : mesh_.bends) {
      state_.bend_set.push_back((state_.x[b.a] - 2 * state_.x[b.mid] + state_.x[b.c]).norm());
    }
  }
  if (state_.stretch_set.empty()) state_.stretch_set.assign(stretch_.lane_count(), 0.0f);
  if (state_.shear_set.empty()) state_.shear_set.assign(shear_.lane_count(), 0.0f);
  x_ = x_prev_ = Widen(state_.x);
  v_ = Widen(state_.v);
  contact_.Invalidate();
  rigid_contact_.Invalidate();
  since_air_ = 0;
}

void Cloth::MeasureAir() {
  // Pressure drag of each face, 1/2 rho C v_n^2 A along its normal. A bag's two
  // layers share the flow, so each takes half.
  for (Vec4f& f : air_) f.setZero();
  const float c = 0.5f * kAirDensity_kg_m3 * static_cast<float>(bag_.drag_coefficient) /
                  static_cast<float>(mesh_.layers);
  const std::size_t count = mesh_.triangles.size();
  for (std::size_t i = 0; i < count; i += 4) {
    const std::array<const std::array<int, 3>*, 4> t = {
        &mesh_.triangles[i], &mesh_.triangles[std::min(i + 1, count - 1)],
        &mesh_.triangles[std::min(i + 2, count - 1)], &mesh_.triangles[std::min(i + 3, count - 1)]};
    Float4 ab[4], ad[4], sum[4];
    for (int k = 0; k < 4; ++k) {
      const auto& [n0, n1, n2] = *t[k];
      const Float4 a = Load(x_[n0]);
      ab[k] = Load(x_[n1]) - a;
      ad[k] = Load(x_[n2]) - a;
      sum[k] = Load(v_[n0]) + Load(v_[n1]) + Load(v_[n2]);
    }
    Transpose(ab[0], ab[1], ab[2], ab[3]);
    Transpose(ad[0], ad[1], ad[2], ad[3]);
    Transpose(sum[0], sum[1], sum[2], sum[3]);
    const Vec3x4 twice = {ab[1] * ad[2] - ab[2] * ad[1], ab[2] * ad[0] - ab[0] * ad[2],
                          ab[0] * ad[1] - ab[1] * ad[0]};
    const Float4 twice_area = Sqrt((twice.x * twice.x + twice.z * twice.z) + twice.y * twice.y);
    const Vec3x4 v = {sum[0] / 3.0f, sum[1] / 3.0f, sum[2] / 3.0f};
    const Float4 along = ((v.x * twice.x + v.z * twice.z) + v.y * twice.y) / twice_area;
    const Float4 push = Float4(-c * 0.5f) * along * Abs(along) / 3.0f;
    Float4 f[4] = {twice.x * push, twice.y * push, twice.z * push, Float4()};
    Transpose(f[0], f[1], f[2], f[3]);
    const int flat = Bits(twice_area < Float4(1e-12f));
    for (std::size_t k = 0; k < std::min<std::size_t>(4, count - i); ++k) {
      if (flat >> k & 1) continue;
      for (const int n : *t[k]) Add(air_[n], f[k]);
    }
  }
}

void Cloth::ApplyAir(float h) {
  if (since_air_ == 0) MeasureAir();
  since_air_ = (since_air_ + 1) % kAirEvery;
  for (std::size_t i = 0; i < v_.size(); ++i) {
    // Never more than stops the node: the force is a few substeps old.
    Vec4f dv = air_[i] * (h * inv_mass_[i]);
    const float dv2 = dv.squaredNorm(), v2 = v_[i].squaredNorm();
    if (dv2 > v2 && dv2 > 0) dv *= std::sqrt(v2 / dv2);
    v_[i] += dv;
  }
}

void Cloth::Predict(float h) {
  contact_.Prepare(x_, v_, h, static_cast<float>(solver_.separation_speed_m_s) * h);
  bends_.Apply(h, x_, state_.bend_set, v_);
  ApplyAir(h);
  const float keep = 1.0f - static_cast<float>(solver_.damping_per_s) * h;
  const Vec4f dv(gravity_m_s2.x() * h, gravity_m_s2.y() * h, gravity_m_s2.z() * h, 0);
  x_prev_ = x_;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    v_[i] = v_[i] * keep + dv;
    x_[i] += v_[i] * h;
  }
}

void Cloth::SolveLinks(float h, int iteration) {
  const bool first = iteration == 0, forward = iteration % 2 == 0;
  const float per_h2 = 1.0f / (h * h);
  const float tension = static_cast<float>(solver_.stretch_compliance_m_N) * per_h2;
  const float compression = static_cast<float>(solver_.compression_compliance_m_N) * per_h2;
  const float shear = static_cast<float>(solver_.shear_compliance_m_N) * per_h2;
  // Compliant directions act once a substep: a second visit would double their
  // stiffness.
  const float per_slip = h * h / kLinkSlip_m;
  const LinkSolver::Friction buckling{buckling_friction_N_ * per_slip, kLinkSlip_m, false};
  const LinkSolver::Friction shearing{shear_friction_N_ * per_slip, kLinkSlip_m, true};
  if (first) {
    const float soft = std::max(compression, shear);
    shear_.Solve({shear, soft, true, true, shearing}, state_.shear_set, x_);
  }
  stretch_.Solve({tension, compression, forward, first, buckling}, state_.stretch_set, x_);
  if (iteration + 1 < solver_.iterations) return;
  for (int k = 0; k < kYarnPasses; ++k) yarns_.Solve(tension, x_prev_, x_);
}

void Cloth::SolveTable() {
  const float floor = 0.5f * mesh_.thickness_m;
  const float mu = static_cast<float>(bag_.friction_table);
  const float most_up = static_cast<float>(solver_.separation_speed_m_s / solver_.substeps_per_s);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    Vec4f& x = x_[i];
    if (x.z() >= floor) continue;
    const float target = std::min(floor, std::max(x_prev_[i].z(), 0.0f) + most_up);
    const float depth = target - x.z();
    if (depth <= 0) continue;
    x.z() = target;
    const float sx = x.x() - x_prev_[i].x(), sy = x.y() - x_prev_[i].y();
    const float slip = std::sqrt(sx * sx + sy * sy);
    const float share = slip > mu * depth ? mu * depth / slip : 1.0f;
    x.x() -= sx * share;
    x.y() -= sy * share;
  }
}

// Yarns at what is held or near a rigid body. What lies by itself, with a cube in it or not, loads
// none.
void Cloth::ListBeside(const std::vector<RigidShape>& shapes) {
  beside_.clear();
  if (state_.held.empty() && !rigid_contact_.IsNearKinematic(shapes)) return;
  std::vector<bool> nodes(x_.size(), false);
  for (const HeldPoint& held : state_.held) {
    for (const int node : held.node) nodes[node] = true;
  }
  rigid_contact_.MarkNear(nodes);
  beside_ = yarns_.GroupsAt(nodes);
}

Vec3f Cloth::At(const HeldPoint& held) const {
  return held.weight[0] * At(held.node[0]) + held.weight[1] * At(held.node[1]) +
         held.weight[2] * At(held.node[2]);
}

void Cloth::SolveHold(float h, const Eigen::Isometry3f& X_WT) {
  const float per_h2 = 1.0f / (h * h);
  for (std::size_t i = 0; i < state_.held.size(); ++i) {
    HeldPoint& held = state_.held[i];
    const Vec3f p = At(held);
    float w = 0;
    for (int k = 0; k < 3; ++k) w += held.weight[k] * held.weight[k] * inv_mass_[held.node[k]];
    const Vec3f target = X_WT * held.p_T;
    Vec3f push = (target - p) / w;
    // The limit is one of the substep, however many sweeps it takes, tethers included.
    const Vec3f wanted_N = held_N_[i] + push * per_h2;
    const float force = wanted_N.norm();
    const float limit = held.share * std::max(state_.hold_limit_N - tethered_N_, 0.0f);
    const bool slips = force > limit;  // the pads give what friction allows
    const Vec3f given_N = slips ? Vec3f(wanted_N * (limit / force)) : wanted_N;
    if (slips) push = (given_N - held_N_[i]) / per_h2;
    for (int k = 0; k < 3; ++k) {
      x_[held.node[k]].head<3>() += push * (held.weight[k] * inv_mass_[held.node[k]]);
    }
    if (slips) held.p_T = X_WT.inverse() * (p + push * w);
    held_N_[i] = given_N;
    hold_force_N_ -= push * per_h2;
  }
}

// Contact has the last word: layers cannot be where the pads want them if they would have to pass
// through each other, so what contact moved from `wanted` by more than pads give slips along. By
// most_m at most, for nodes of a zone are moved for the sake of others.
void Cloth::YieldHold(const Vec3Array& wanted, float most_m, const Eigen::Isometry3f& X_WT) {
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const Vec3f moved = At(state_.held[i]) - wanted[i];
    const float length = moved.norm(), beyond = length - kPadGives * mesh_.thickness_m;
    if (beyond <= 0) continue;
    state_.held[i].p_T += X_WT.linear().transpose() * moved * (std::min(beyond, most_m) / length);
  }
}

void Cloth::LoseWhatSlippedOut() {
  const auto outside = [&](const HeldPoint& held) {
    return std::abs(held.p_T.y()) > state_.pad_half_width_m || held.p_T.z() > 0 ||
           held.p_T.z() < -state_.pad_height_m;
  };
  if (std::erase_if(state_.held, outside) == 0) return;
  if (state_.held.empty()) return EndHold();
  // The pads press on what is left between them.
  float total = 0;
  for (const HeldPoint& held : state_.held) total += held.share;
  for (HeldPoint& held : state_.held) held.share /= total;
  MeasureTethers();
}

void Cloth::Tether(float h, const Eigen::Isometry3f& X_WT) {
  // Long-range attachments (Kim, Chentanez, Mueller 2012): no node further from
  // the hold than the cloth between them is long. Carries what pulls aslant
  // of the yarns.
  if (state_.tether_m.empty()) return;
  float left_N = state_.hold_limit_N - tethered_N_;
  for (const Vec3f& force : held_N_) left_N -= force.norm();
  const float per_h2 = 1.0f / (h * h);
  Vec3Array anchors;
  for (const HeldPoint& held : state_.held) anchors.push_back(X_WT * held.p_T);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    const Vec3f d = At(i) - anchors[state_.tether_to[i]];
    const float length2 = d.squaredNorm(), most = state_.tether_m[i];
    if (length2 <= most * most) continue;
    const float length = std::sqrt(length2);
    Vec3f force = d * ((most / length - 1.0f) * per_h2 / inv_mass_[i]);
    // Past the hold's limit the yarns alone pull, and what is held slips.
    const float norm = force.norm();
    if (norm > left_N) force *= std::max(left_N, 0.0f) / norm;
    left_N -= norm;
    tethered_N_ += std::min(norm, std::max(left_N + norm, 0.0f));
    x_[i].head<3>() += force * (inv_mass_[i] / per_h2);
    hold_force_N_ -= force;
  }
}

void Cloth::SolveConstraints(float h, const Eigen::Isometry3f& X_WT,
                             std::vector<RigidShape>& shapes) {
  if (rigid_contact_.Find(x_, shapes)) ListBeside(shapes);
  for (RigidShape& shape : shapes) {
    shape.impulse.setZero();
    shape.angular_impulse.setZero();
  }
  hold_force_N_.setZero();
  held_N_.assign(state_.held.size(), Vec3f::Zero());
  tethered_N_ = 0;

  for (int k = 0; k < solver_.iterations; ++k) {
    SolveHold(h, X_WT);
    Tether(h, X_WT);
    SolveLinks(h, k);
    contact_.Solve(x_prev_, inv_mass_, x_);
    rigid_contact_.Solve(x_prev_, inv_mass_, h, shapes, x_);
    SolveTable();
  }
  // What fingers pull and push at, and what a cube hangs in, goes through few yarns, and two sweeps
  // leave those too long. The layers' contact is among them, or yarns pull held layers into each
  // other, contact has to part them again, and the bag trembles or loses a layer from the grip.
  // With the fingers' contact too they end longer still: what yields is the overlap. A cube weighs
  // as much as a bag, and yields itself; one that lies on the table loads no yarn, and would press
  // cloth into the table here.
  const float tension = static_cast<float>(solver_.stretch_compliance_m_N) / (h * h);
  const bool cube_hangs = std::ranges::any_of(shapes, [&](const RigidShape& shape) {
    const float clear_m = shape.half.norm() + 2 * mesh_.thickness_m;  // for two layers beneath it
    return shape.inv_mass > 0 && shape.X_WS.translation().z() > clear_m;
  });
  Vec3Array wanted(state_.held.size());  // by pads and yarns, before contact has its say
  for (int k = 0; k < kBesideSweeps && !beside_.empty(); ++k) {
    SolveHold(h, X_WT);
    Tether(h, X_WT);
    yarns_.Solve(tension, beside_, x_prev_, x_);
    for (std::size_t i = 0; i < wanted.size(); ++i) wanted[i] = At(state_.held[i]);
    contact_.Solve(x_prev_, inv_mass_, x_);
    if (cube_hangs) rigid_contact_.SolveYielding(x_prev_, inv_mass_, h, shapes, x_);
  }
  const float floor = 0.5f * mesh_.thickness_m;
  contact_.Enforce(x_prev_, inv_mass_, h, floor, x_);
  if (!beside_.empty()) {
    YieldHold(wanted, static_cast<float>(solver_.separation_speed_m_s) * h, X_WT);
  }
  LoseWhatSlippedOut();
  const float per_h = 1.0f / h;
  for (std::size_t i = 0; i < x_.size(); ++i) {
    v_[i] = (x_[i] - x_prev_[i]) * per_h;
    // What the table lifted out of itself does not fly.
    if (x_prev_[i].z() < floor && x_[i].z() <= floor && v_[i].z() > 0) v_[i].z() = 0;
  }
  contact_.EndSubstep(inv_mass_, h, v_);
  rigid_contact_.EndSubstep(inv_mass_, h, v_);
  for (std::size_t i = 0; i < x_.size(); ++i) {
    state_.x[i] = x_[i].head<3>();
    state_.v[i] = v_[i].head<3>();
  }
  rigid_contact_.MeasureSqueeze(x_, holding(), shapes);
}

bool Cloth::IsNear(const RigidShape& shape, float distance_m) const {
  const Vec3f reach = shape.half + Vec3f::Constant(distance_m + 0.5f * mesh_.thickness_m);
  const Eigen::Matrix3f R_SW = shape.X_WS.linear().transpose();
  Vec3Array p_S;
  p_S.reserve(state_.x.size());
  for (const Vec3f& p : state_.x) p_S.push_back(R_SW * (p - shape.X_WS.translation()));
  for (const auto& t : mesh_.triangles) {
    const Vec3f &a = p_S[t[0]], &b = p_S[t[1]], &c = p_S[t[2]];
    if ((a.cwiseMin(b).cwiseMin(c).array() <= reach.array()).all() &&
        (a.cwiseMax(b).cwiseMax(c).array() >= -reach.array()).all()) {
      return true;
    }
  }
  return false;
}

float Cloth::MaxSpeed() const {
  float most = 0;
  for (const Vec3f& v : state_.v) {
    const float v2 = v.squaredNorm();
    if (!(v2 <= std::numeric_limits<float>::max())) return std::numeric_limits<float>::infinity();
    most = std::max(most, v2);
  }
  return std::sqrt(most);
}

float Cloth::RmsSpeed() const {
  float sum = 0;
  for (const Vec3f& v : state_.v) sum += v.squaredNorm();
  return std::sqrt(sum / static_cast<float>(state_.v.size()));
}

float Cloth::MaxStretch(int* where) const {
  float most = 0;
  for (const ClothLink& link : mesh_.stretch) {
    const float ratio = (state_.x[link.a] - state_.x[link.b]).norm() / link.rest_m;
    if (ratio > most) {
      most = ratio;
      if (where) *where = link.a;
    }
  }
  return most;
}

namespace {

// Visits the points of a fine grid on every triangle that lie between the pads.
template <class Visit>
void ForPointsBetween(const ClothMesh& mesh, const Vec3Array& x, const PadGap& gap, Visit visit) {
  const Eigen::Isometry3f X_TW = gap.X_WT.inverse();
  const float half_open = 0.5f * gap.opening_m + 0.5f * mesh.thickness_m;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& n = mesh.triangles[t];
    const Vec3f a = X_TW * x[n[0]], b = X_TW * x[n[1]], c = X_TW * x[n[2]];
    const Vec3f lo = a.cwiseMin(b).cwiseMin(c), hi = a.cwiseMax(b).cwiseMax(c);
    if (lo.x() > half_open || hi.x() < -half_open || lo.y() > gap.half_width_m ||
        hi.y() < -gap.half_width_m || lo.z() > 0 || hi.z() < -gap.height_m) {
      continue;
    }
    const auto rest = [&](int k) { return mesh.uv[n[k]]; };
    const Eigen::Vector2f e1 = rest(1) - rest(0), e2 = rest(2) - rest(0);
    const float area = 0.5f * std::abs(e1.x() * e2.y() - e1.y() * e2.x());
    constexpr int kPoints = kHoldSamples * kHoldSamples;
    for (int i = 0; i < kHoldSamples; ++i) {
      for (int j = 0; j < 2 * (kHoldSamples - i) - 1; ++j) {
        // Centres of the kHoldSamples^2 equal small triangles.
        const float k = static_cast<float>(j / 2);
        const float third = j % 2 == 0 ? 1 / 3.0f : 2 / 3.0f;
        const float w1 = (static_cast<float>(i) + third) / kHoldSamples;
        const float w2 = (k + third) / kHoldSamples;
        const Vec3f weight(1 - w1 - w2, w1, w2);
        const Vec3f p_T = weight[0] * a + weight[1] * b + weight[2] * c;
        if (std::abs(p_T.x()) > half_open || std::abs(p_T.y()) > gap.half_width_m || p_T.z() > 0 ||
            p_T.z() < -gap.height_m) {
          continue;
        }
        visit(static_cast<int>(t), weight, p_T, area / kPoints);
      }
    }
  }
}

}  // namespace

float Cloth::StackBetween(const PadGap& gap) const {
  constexpr int kAcross = 2, kUp = 4;  // cells of about 11 x 9 mm
  std::array<float, kAcross * kUp> area{};
  ForPointsBetween(mesh_, state_.x, gap, [&](int, const Vec3f&, const Vec3f& p_T, float a) {
    const int i =
        std::min(kAcross - 1, static_cast<int>((p_T.y() / gap.half_width_m + 1) * 0.5f * kAcross));
    const int j = std::min(kUp - 1, static_cast<int>(-p_T.z() / gap.height_m * kUp));
    area[j * kAcross + i] += a;
  });
  float most = 0;
  for (const float a : area) most = std::max(most, a);
  const float cell = 2 * gap.half_width_m * gap.height_m / (kAcross * kUp);
  return most / cell * mesh_.thickness_m;
}

void Cloth::BeginHold(const PadGap& gap, float limit_N) {
  EndHold();
  float total = 0;
  int last = -1;
  ForPointsBetween(mesh_, state_.x, gap,
                   [&](int t, const Vec3f& weight, const Vec3f& p_T, float area) {
                     // One held point per triangle: the mean of what lies between the pads.
                     if (t != last) {
                       HeldPoint held;
                       held.node = mesh_.triangles[t];
                       held.layer = mesh_.triangle_layer[t];
                       state_.held.push_back(held);
                       last = t;
                     }
                     HeldPoint& held = state_.held.back();
                     held.weight += weight * area;
                     held.p_T += p_T * area;
                     held.share += area;
                     total += area;
                   });
  if (state_.held.empty()) return;
  for (HeldPoint& held : state_.held) {
    held.weight /= held.share;
    held.p_T /= held.share;
    held.share /= total;
  }
  state_.hold_limit_N = limit_N;
  state_.pad_half_width_m = gap.half_width_m;
  state_.pad_height_m = gap.height_m;
  MeasureTethers();
}

void Cloth::MeasureTethers() {
  // Geodesic distance of every node from the held points, along yarns and
  // diagonals (Dijkstra).
  const std::size_t n = state_.x.size();
  std::vector<std::vector<std::pair<int, float>>> neighbours(n);
  for (const auto* links : {&mesh_.stretch, &mesh_.shear}) {
    for (const ClothLink& link : *links) {
      neighbours[link.a].emplace_back(link.b, link.rest_m);
      neighbours[link.b].emplace_back(link.a, link.rest_m);
    }
  }
  state_.tether_m.assign(n, std::numeric_limits<float>::max());
  state_.tether_to.assign(n, 0);
  using Entry = std::pair<float, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (std::size_t k = 0; k < state_.held.size(); ++k) {
    const HeldPoint& held = state_.held[k];
    Eigen::Vector2f uv = Eigen::Vector2f::Zero();
    for (int c = 0; c < 3; ++c) uv += held.weight[c] * mesh_.uv[held.node[c]];
    for (const int node : held.node) {
      const float d = (mesh_.uv[node] - uv).norm();
      if (d < state_.tether_m[node]) {
        state_.tether_m[node] = d;
        state_.tether_to[node] = static_cast<int>(k);
        open.emplace(d, node);
      }
    }
  }
  while (!open.empty()) {
    const auto [d, i] = open.top();
    open.pop();
    if (d > state_.tether_m[i]) continue;
    for (const auto& [j, length] : neighbours[i]) {
      if (d + length < state_.tether_m[j]) {
        state_.tether_m[j] = d + length;
        state_.tether_to[j] = state_.tether_to[i];
        open.emplace(d + length, j);
      }
    }
  }
  for (float& d : state_.tether_m) d = d * kTetherSlack + 0.001f;
}

void Cloth::GatherHold(float factor) {
  for (HeldPoint& held : state_.held) held.p_T.head<2>() *= factor;
}

void Cloth::EndHold() {
  state_.held.clear();
  state_.tether_m.clear();
  state_.tether_to.clear();
  state_.hold_limit_N = state_.pad_half_width_m = state_.pad_height_m = 0;
}

}  // namespace gusset
