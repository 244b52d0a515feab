#include "sim/cloth/rigid_contact.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gusset {
namespace {

constexpr int kFindEvery = 4;  // substeps between searches
constexpr float kReach_m = 0.008f;
constexpr float kBeyond_m = 1e-4f;
// Stiffness of cloth across its thickness, per area: a cotton of 1.5 mm loses some 0.5 mm under
// 5 kPa (KES-FB3, the usual compression test).
constexpr float kCompression_N_m3 = 1e7f;
// What lies beneath a point of the cloth within this distance tells whether the point is borne by
// the table: a sample or two each way.
constexpr float kColumn_m = 0.015f;
// It is, if there is more cloth than air down there.
constexpr float kBearingShare = 0.5f;
constexpr float kDownwards = -0.7f;  // height of a normal that points down rather than sideways

// Moves a point of the cloth, p in the world, by `move` relative to a shape that yields along n.
template <class Sample>
void Push(const Sample& m, const Vec3f& p, const Vec3f& n, const Vec3f& move, float w, float h,
          const std::vector<float>& inv_mass, RigidShape& shape, Vec4Array& x) {
  const Vec3f arm = p - shape.X_WS.translation();
  float w_body = shape.inv_mass;
  if (w_body > 0) {
    const Vec3f rn = arm.cross(n);
    w_body += rn.dot(shape.inv_inertia_W * rn);
  }
  const Vec3f push = move / (w + w_body);
  for (int k = 0; k < m.count; ++k) {
    x[m.node[k]].template head<3>() += push * (m.weight[k] * inv_mass[m.node[k]]);
  }
  const Vec3f impulse = -push / h;
  shape.impulse += impulse;
  shape.angular_impulse += arm.cross(impulse);
  if (w_body > 0) {
    // The body yields within the substep too, so that the next sample sees it
    // where it will be.
    shape.X_WS.translation() += impulse * (shape.inv_mass * h);
    const Vec3f turn = shape.inv_inertia_W * arm.cross(impulse) * h;
    const float angle = turn.norm();
    if (angle > 1e-9f) {
      shape.X_WS.linear() =
          Eigen::AngleAxisf(angle, turn / angle).toRotationMatrix() * shape.X_WS.linear();
    }
  }
}

}  // namespace

RigidContact::RigidContact(const ClothMesh& mesh, float area_m2, float separation_speed_m_s)
    : mesh_(mesh),
      gap_m_(0.5f * mesh.thickness_m),
      separation_speed_m_s_(separation_speed_m_s),
      beyond_(mesh.rest.size()) {
  for (int i = 0; i < mesh.node_count(); ++i) samples_.push_back({{i, i, i}, {1, 0, 0}, 1});
  for (const auto& e : mesh.edges) samples_.push_back({{e[0], e[1], e[1]}, {0.5f, 0.5f, 0}, 2});
  for (const auto& t : mesh.triangles) {
    samples_.push_back({{t[0], t[1], t[2]}, {1 / 3.0f, 1 / 3.0f, 1 / 3.0f}, 3});
  }
  sample_area_m2_ = area_m2 / static_cast<float>(samples_.size());
}

Vec3f RigidContact::Sample::At(const Vec4Array& x) const {
  Vec3f p = weight[0] * x[node[0]].head<3>();
  for (int k = 1; k < count; ++k) p += weight[k] * x[node[k]].head<3>();
  return p;
}

void RigidContact::Invalidate() {
  since_find_ = 0;
  near_samples_.clear();
}

bool RigidContact::Find(const Vec4Array& x, const std::vector<RigidShape>& shapes) {
  const bool look = since_find_ == 0 || near_samples_.size() != shapes.size();
  since_find_ = (since_find_ + 1) % kFindEvery;
  if (!look) return false;
  near_samples_.assign(shapes.size(), {});
  Vec3f cloth_lo = x[0].head<3>(), cloth_hi = cloth_lo;
  for (const Vec4f& p : x) {
    cloth_lo = cloth_lo.cwiseMin(p.head<3>());
    cloth_hi = cloth_hi.cwiseMax(p.head<3>());
  }
  const float reach = kReach_m + gap_m_;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    const RigidShape& shape = shapes[s];
    const Vec3f extent = shape.X_WS.linear().cwiseAbs() * shape.half;
    const Vec3f lo = shape.X_WS.translation() - extent - Vec3f::Constant(reach);
    const Vec3f hi = shape.X_WS.translation() + extent + Vec3f::Constant(reach);
    if ((lo.array() > cloth_hi.array()).any() || (hi.array() < cloth_lo.array()).any()) continue;
    // A sample whose nodes all lie beyond one side of the box lies there too; rounding is far below
    // what the box is grown by.
    const Vec3f lower = lo - Vec3f::Constant(kBeyond_m), upper = hi + Vec3f::Constant(kBeyond_m);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Float4 p = Float4::Load(x[i].data());
      const int below = Bits(p < Float4(lower.x(), lower.y(), lower.z(), 0));
      const int above = Bits(Float4(upper.x(), upper.y(), upper.z(), 0) < p);
      beyond_[i] = static_cast<std::uint8_t>(below << 3 | above);
    }
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sample& m = samples_[i];
      if (beyond_[m.node[0]] & beyond_[m.node[1]] & beyond_[m.node[2]]) continue;
      const Vec3f p = m.At(x);
      if ((p.array() < lo.array()).any() || (p.array() > hi.array()).any()) continue;
      near_samples_[s].push_back(static_cast<int>(i));
    }
  }
  return true;
}

bool RigidContact::MarkNearKinematic(const std::vector<RigidShape>& shapes,
                                     std::vector<bool>& nodes) const {
  bool any = false;
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].inv_mass > 0) continue;
    for (const int index : near_samples_[s]) {
      const Sample& m = samples_[index];
      for (int k = 0; k < m.count; ++k) nodes[m.node[k]] = true;
      any = true;
    }
  }
  return any;
}

void RigidContact::Solve(const Vec4Array& x_prev, const std::vector<float>& inv_mass, float h,
                         std::vector<RigidShape>& shapes, Vec4Array& x) const {
  const Substep substep{x_prev, inv_mass, h};
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    SolveSamples(substep, near_samples_[s], shapes[s], x);
  }
}

void RigidContact::SolveSamples(const Substep& substep, const std::vector<int>& candidates,
                                RigidShape& shape, Vec4Array& x) const {
  if (candidates.empty()) return;
  const auto& [x_prev, inv_mass, h] = substep;
  const float most_out = separation_speed_m_s_ * h;
  const Eigen::Isometry3f X_SW_prev = shape.X_WS_prev.inverse();
  for (const int index : candidates) {
    const Sample& m = samples_[index];
    const Vec3f p = m.At(x);
    const Vec3f p_S = shape.X_WS.linear().transpose() * (p - shape.X_WS.translation());
    if (ClearlyOff(shape, p_S, gap_m_)) continue;
    Vec3f n_S;
    const float distance = SignedDistance(shape, p_S, n_S);
    if (distance >= gap_m_) continue;
    const Vec3f p_prev = m.At(x_prev);
    float w = 0;
    for (int k = 0; k < m.count; ++k) w += m.weight[k] * m.weight[k] * inv_mass[m.node[k]];
    // As between layers: approach is stopped at once, old overlap undone
    // slowly.
    const Vec3f p_S_prev = X_SW_prev * p_prev;
    Vec3f n_prev;
    const float before = SignedDistance(shape, p_S_prev, n_prev);
    const float target = std::min(gap_m_, std::max(before, -gap_m_) + most_out);
    const float depth = target - distance;
    if (depth <= 0) continue;
    const Vec3f n = shape.X_WS.linear() * n_S;
    const Vec3f slip3 = p - shape.X_WS * p_S_prev;  // relative to the body's own motion
    const Vec3f slip = slip3 - n * n.dot(slip3);
    const float slip_m = slip.norm();
    const float most = shape.friction * depth;
    const Vec3f move = n * depth - slip * (slip_m > most ? most / slip_m : 1.0f);
    Push(m, p, n, move, w, h, inv_mass, shape, x);
  }
}

// Whether cloth fills the column from p down to the table.
bool RigidContact::BorneByTable(const Vec4Array& x, const Vec3f& p) const {
  float area_m2 = 0;
  for (const Sample& m : samples_) {
    const Vec3f q = m.At(x);
    if (q.z() > p.z() || (q - p).head<2>().squaredNorm() > kColumn_m * kColumn_m) continue;
    area_m2 += sample_area_m2_;
  }
  const float height_m = p.z() + gap_m_;
  const float column_m3 = std::numbers::pi_v<float> * kColumn_m * kColumn_m * height_m;
  return area_m2 * 2 * gap_m_ > kBearingShare * column_m3;
}

// What contact could not push out of a kinematic body is caught between it and something else, and
// thinner than it would be: it pushes back as compressed cloth does. Impulses and the hold's forces
// are all that changes the cloth's momentum, so this is a pair of forces that pass through it from
// the body to what it is caught against. While the gripper holds cloth that is the gripper again
// (other finger, or what is held), so that nothing is felt of it as a whole, but where the body
// presses down on cloth that the table bears.
void RigidContact::MeasureSqueeze(const Vec4Array& x, bool held,
                                  std::vector<RigidShape>& shapes) const {
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    RigidShape& shape = shapes[s];
    if (shape.inv_mass != 0) continue;
    shape.squeeze.setZero();
    shape.squeeze_minus_x = 0;
    for (const int index : near_samples_[s]) {
      const Vec3f p = samples_[index].At(x);
      const Vec3f p_S = shape.X_WS.linear().transpose() * (p - shape.X_WS.translation());
      if (ClearlyOff(shape, p_S, gap_m_)) continue;
      Vec3f n_S;
      const float distance = SignedDistance(shape, p_S, n_S);
      if (distance >= gap_m_) continue;
      const float overlap = std::min(gap_m_ - distance, 2 * gap_m_);
      const float force = kCompression_N_m3 * sample_area_m2_ * overlap;
      if (n_S.x() < -0.7f) shape.squeeze_minus_x += force;
      const Vec3f n = shape.X_WS.linear() * n_S;
      if (held && (n.z() > kDownwards || !BorneByTable(x, p))) continue;
      shape.squeeze -= n * force;
    }
  }
}

}  // namespace gusset
