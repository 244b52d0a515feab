#include "sim/cloth/rigid_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace gusset {
namespace {

constexpr int kFindEvery = 4;  // substeps between searches
constexpr float kReach_m = 0.008f;
constexpr float kBeyond_m = 1e-4f;
// Stiffness of cloth across its thickness, per area: a cotton of 1.5 mm loses some 0.5 mm under
// 5 kPa (KES-FB3, the usual compression test).
constexpr float kCompression_N_m3 = 1e7f;
constexpr float kLeastArea_m2 = 1e-9f;  // twice that of a triangle that has a normal
// What lies beneath a point of the cloth within this distance tells whether the point is borne by
// the table: a sample or two each way.
constexpr float kColumn_m = 0.015f;
// It is, if there is more cloth than air down there.
constexpr float kBearingShare = 0.5f;
constexpr float kDownwards = -0.7f;  // height of a normal that points down rather than sideways

bool YieldingBox(const RigidShape& shape) {
  return shape.kind == RigidShape::Kind::kBox && shape.inv_mass > 0;
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

float RigidContact::Sample::InvMass(const std::vector<float>& inv_mass) const {
  float w = 0;
  for (int k = 0; k < count; ++k) w += weight[k] * weight[k] * inv_mass[node[k]];
  return w;
}

void RigidContact::Invalidate() {
  since_find_ = 0;
  near_samples_.clear();
}

// Notes which sides of a box each node is beyond: a sample whose nodes all lie beyond one side lies
// there too. Rounding is far below what the box is grown by.
void RigidContact::MarkBeyond(const Vec3f& lo, const Vec3f& hi, const Vec4Array& x) {
  const Float4 lower(lo.x() - kBeyond_m, lo.y() - kBeyond_m, lo.z() - kBeyond_m, 0);
  const Float4 upper(hi.x() + kBeyond_m, hi.y() + kBeyond_m, hi.z() + kBeyond_m, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Float4 p = Float4::Load(x[i].data());
    const int below = Bits(p < lower), above = Bits(upper < p);
    beyond_[i] = static_cast<std::uint8_t>(below << 3 | above);
  }
}

bool RigidContact::Find(const Vec4Array& x, const std::vector<RigidShape>& shapes) {
  const bool look = since_find_ == 0 || near_samples_.size() != shapes.size();
  since_find_ = (since_find_ + 1) % kFindEvery;
  if (!look) return false;
  near_samples_.assign(shapes.size(), {});
  near_triangles_.assign(shapes.size(), {});
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
    MarkBeyond(lo, hi, x);
    for (std::size_t i = 0; i < samples_.size(); ++i) {
      const Sample& m = samples_[i];
      if (beyond_[m.node[0]] & beyond_[m.node[1]] & beyond_[m.node[2]]) continue;
      const Vec3f p = m.At(x);
      if ((p.array() < lo.array()).any() || (p.array() > hi.array()).any()) continue;
      near_samples_[s].push_back(static_cast<int>(i));
    }
    if (!YieldingBox(shape)) continue;
    for (std::size_t t = 0; t < mesh_.triangles.size(); ++t) {
      const std::array<int, 3>& n = mesh_.triangles[t];
      if (beyond_[n[0]] & beyond_[n[1]] & beyond_[n[2]]) continue;
      near_triangles_[s].push_back(static_cast<int>(t));
    }
  }
  return true;
}

bool RigidContact::IsNearKinematic(const std::vector<RigidShape>& shapes) const {
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].inv_mass == 0 && !near_samples_[s].empty()) return true;
  }
  return false;
}

void RigidContact::MarkNear(std::vector<bool>& nodes) const {
  for (const std::vector<int>& near : near_samples_) {
    for (const int index : near) {
      const Sample& m = samples_[index];
      for (int k = 0; k < m.count; ++k) nodes[m.node[k]] = true;
    }
  }
}

void RigidContact::Solve(const Vec4Array& x_prev, const std::vector<float>& inv_mass, float h,
                         std::vector<RigidShape>& shapes, Vec4Array& x) {
  for (std::size_t s = 0; s < shapes.size(); ++s) Solve({x_prev, inv_mass, h}, s, shapes, x);
}

void RigidContact::SolveYielding(const Vec4Array& x_prev, const std::vector<float>& inv_mass,
                                 float h, std::vector<RigidShape>& shapes, Vec4Array& x) {
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    if (shapes[s].inv_mass > 0) Solve({x_prev, inv_mass, h}, s, shapes, x);
  }
}

void RigidContact::Solve(const Substep& substep, std::size_t shape, std::vector<RigidShape>& shapes,
                         Vec4Array& x) {
  SolveSamples(substep, near_samples_[shape], shapes[shape], x);
  if (YieldingBox(shapes[shape])) SolveEdges(substep, near_triangles_[shape], shapes[shape], x);
}

void RigidContact::PushOut(const Substep& substep, const Sample& m, const Overlap& overlap,
                           RigidShape& shape, Vec4Array& x) {
  const auto& [x_prev, inv_mass, h] = substep;
  // As between layers: approach is stopped at once, old overlap undone slowly.
  const float target =
      std::min(gap_m_, std::max(overlap.distance_before_m, -gap_m_) + separation_speed_m_s_ * h);
  const float depth = target - overlap.distance_m;
  if (depth <= 0) return;
  const Vec3f p = m.At(x);
  const Vec3f& n = overlap.normal;
  const Vec3f slip3 = p - shape.X_WS * overlap.p_S_before;  // relative to the body's own motion
  const Vec3f slip = slip3 - n * n.dot(slip3);
  const float slip_m = slip.norm();
  const float most = shape.friction * depth;
  const Vec3f move = n * depth - slip * (slip_m > most ? most / slip_m : 1.0f);
  const Vec3f arm = p - shape.X_WS.translation();
  const float w_body = InvMassAt(shape, arm, n);
  const Vec3f push = move / (m.InvMass(inv_mass) + w_body);
  for (int k = 0; k < m.count; ++k) {
    x[m.node[k]].head<3>() += push * (m.weight[k] * inv_mass[m.node[k]]);
  }
  if (w_body > 0 && overlap.distance_before_m < gap_m_) pushed_.push_back({m, &shape, n, arm});
  const Vec3f impulse = -push / h;
  shape.impulse += impulse;
  shape.angular_impulse += arm.cross(impulse);
  if (w_body > 0) {
    // The body yields within the substep too, so that the next contact sees it where it will be.
    shape.X_WS.translation() += impulse * (shape.inv_mass * h);
    const Vec3f turn = shape.inv_inertia_W * arm.cross(impulse) * h;
    const float angle = turn.norm();
    if (angle > 1e-9f) {
      shape.X_WS.linear() =
          Eigen::AngleAxisf(angle, turn / angle).toRotationMatrix() * shape.X_WS.linear();
    }
  }
}

void RigidContact::SolveSamples(const Substep& substep, const std::vector<int>& candidates,
                                RigidShape& shape, Vec4Array& x) {
  if (candidates.empty()) return;
  const Eigen::Isometry3f X_SW_prev = shape.X_WS_prev.inverse();
  for (const int index : candidates) {
    const Sample& m = samples_[index];
    const Vec3f p = m.At(x);
    const Vec3f p_S = shape.X_WS.linear().transpose() * (p - shape.X_WS.translation());
    if (ClearlyOff(shape, p_S, gap_m_)) continue;
    Vec3f n_S;
    const float distance = SignedDistance(shape, p_S, n_S);
    if (distance >= gap_m_) continue;
    const Vec3f p_S_prev = X_SW_prev * m.At(substep.x_prev);
    Vec3f n_prev;
    const float before = SignedDistance(shape, p_S_prev, n_prev);
    PushOut(substep, m, {shape.X_WS.linear() * n_S, distance, before, p_S_prev}, shape, x);
  }
}

// A box's deepest point along a triangle's normal is a corner, and only that corner's edges lead up
// to it. The part of each edge that lies over the triangle is found by clipping; its end nearest to
// the corner is deepest. A point over the triangle and beyond its plane, moved back onto the plane
// against the normal, stays in the box, since the normal lies between the faces' that meet there:
// so what is found is cloth that is in the box.
std::optional<RigidContact::EdgeContact> RigidContact::FindEdge(const RigidShape& box, int triangle,
                                                                const Vec4Array& x) const {
  const std::array<int, 3>& node = mesh_.triangles[triangle];
  const Eigen::Matrix3f R_SW = box.X_WS.linear().transpose();
  const auto at = [&](int k) {
    return Vec3f(R_SW * (x[node[k]].head<3>() - box.X_WS.translation()));
  };
  const Vec3f a = at(0), b = at(1), c = at(2);
  const Vec3f reach = box.half + Vec3f::Constant(gap_m_);
  if ((a.cwiseMin(b).cwiseMin(c).array() >= reach.array()).any() ||
      (a.cwiseMax(b).cwiseMax(c).array() <= -reach.array()).any()) {
    return std::nullopt;
  }
  const Vec3f ab = b - a, ac = c - a, cross = ab.cross(ac);
  const float twice_area = cross.norm();
  if (twice_area < kLeastArea_m2) return std::nullopt;
  // Away from the box's middle.
  const Vec3f m = cross * ((cross.dot(a) < 0 ? -1.0f : 1.0f) / twice_area);
  const Vec3f sign(m.x() < 0 ? -1.0f : 1.0f, m.y() < 0 ? -1.0f : 1.0f, m.z() < 0 ? -1.0f : 1.0f);
  const Vec3f corner = box.half.cwiseProduct(sign);
  if (m.dot(a - corner) >= gap_m_) return std::nullopt;

  // Barycentric coordinates above the plane are linear: w = weight . (q - a), the first 1 - w1 -
  // w2.
  const Vec3f to_b = ac.cross(cross) / (twice_area * twice_area);
  const Vec3f to_c = cross.cross(ab) / (twice_area * twice_area);
  const auto weights = [&](const Vec3f& q) {
    const float w1 = to_b.dot(q - a), w2 = to_c.dot(q - a);
    return Vec3f(1 - w1 - w2, w1, w2);
  };
  const Vec3f w_corner = weights(corner);
  std::optional<EdgeContact> deepest;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3f other_end = corner;
    other_end[axis] = -corner[axis];
    const Vec3f w_rate = weights(other_end) - w_corner;
    float from = 0, to = 1;
    for (int k = 0; k < 3; ++k) {
      // w_corner + s w_rate >= 0
      if (w_rate[k] > 0) {
        from = std::max(from, -w_corner[k] / w_rate[k]);
      } else if (w_rate[k] < 0) {
        to = std::min(to, -w_corner[k] / w_rate[k]);
      } else if (w_corner[k] < 0) {
        to = -1;
      }
    }
    if (from > to) continue;
    const Vec3f q = corner + from * (other_end - corner);
    const float distance = m.dot(a - q);
    if (distance >= gap_m_ || (deepest && distance >= deepest->distance_m)) continue;
    const Vec3f w = w_corner + from * w_rate;
    deepest = {{node, {w[0], w[1], w[2]}, 3}, q, m, distance};
  }
  return deepest;
}

// The dual of SolveSamples: points of the box, and the cloth's normal.
void RigidContact::SolveEdges(const Substep& substep, const std::vector<int>& triangles,
                              RigidShape& box, Vec4Array& x) {
  const Eigen::Isometry3f X_SW_prev = box.X_WS_prev.inverse();
  for (const int t : triangles) {
    const std::optional<EdgeContact> c = FindEdge(box, t, x);
    if (!c) continue;
    const Vec3f p_S_prev = X_SW_prev * c->at.At(substep.x_prev);
    const float before = c->normal_S.dot(p_S_prev - c->q_S);
    PushOut(substep, c->at, {box.X_WS.linear() * c->normal_S, c->distance_m, before, p_S_prev}, box,
            x);
  }
}

void RigidContact::EndSubstep(const std::vector<float>& inv_mass, float h, Vec4Array& v) {
  for (const Pushed& c : pushed_) {
    const Sample& m = c.at;
    RigidShape& shape = *c.shape;
    // The body's own point, from where it was to where it is.
    const Vec3f p = shape.X_WS.translation() + c.arm;
    const Vec3f v_body = (p - shape.X_WS_prev * (shape.X_WS.inverse() * p)) / h;
    const float apart = c.normal.dot(m.At(v) - v_body);
    if (apart <= 0) continue;
    const Vec3f impulse =
        c.normal * (apart / (m.InvMass(inv_mass) + InvMassAt(shape, c.arm, c.normal)));
    for (int k = 0; k < m.count; ++k) {
      v[m.node[k]].head<3>() -= impulse * (m.weight[k] * inv_mass[m.node[k]]);
    }
    shape.impulse += impulse;
    shape.angular_impulse += c.arm.cross(impulse);
  }
  pushed_.clear();
}

// Whether cloth, of which `beneath` holds all samples in the column from p down to the table, fills
// it.
bool RigidContact::BorneByTable(const Vec3Array& beneath, const Vec3f& p) const {
  const float height_m = p.z() + gap_m_;
  const float column_m3 = std::numbers::pi_v<float> * kColumn_m * kColumn_m * height_m;
  const float sample_m3 = sample_area_m2_ * 2 * gap_m_;
  int inside = 0;
  for (const Vec3f& q : beneath) {
    inside += (q.z() <= p.z()) & ((q - p).head<2>().squaredNorm() <= kColumn_m * kColumn_m);
  }
  return sample_m3 * static_cast<float>(inside) > kBearingShare * column_m3;
}

// Places of the samples that may lie in the columns beneath what presses.
Vec3Array RigidContact::SamplesBeneath(const std::vector<Pressing>& pressing, const Vec4Array& x) {
  Vec3f lo = Vec3f::Constant(std::numeric_limits<float>::max()), hi = -lo;
  for (const Pressing& at : pressing) {
    lo = lo.cwiseMin(at.p);
    hi = hi.cwiseMax(at.p);
  }
  const Vec3f column(kColumn_m, kColumn_m, 0);
  lo -= column;
  hi += column;
  lo.z() = std::numeric_limits<float>::lowest();
  MarkBeyond(lo, hi, x);
  Vec3Array beneath;
  for (const Sample& m : samples_) {
    if (beyond_[m.node[0]] & beyond_[m.node[1]] & beyond_[m.node[2]]) continue;
    beneath.push_back(m.At(x));
  }
  return beneath;
}

// What contact could not push out of a kinematic body is caught between it and something else, and
// thinner than it would be: it pushes back as compressed cloth does. Impulses and the hold's forces
// are all that changes the cloth's momentum, so this is a pair of forces that pass through it from
// the body to what it is caught against. While the gripper holds cloth that is the gripper again
// (other finger, or what is held), so that nothing is felt of it as a whole, but where the body
// presses down on cloth that the table bears.
void RigidContact::MeasureSqueeze(const Vec4Array& x, bool held, std::vector<RigidShape>& shapes) {
  std::vector<Pressing> pressing;  // down, while cloth is held
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
      if (!held) {
        shape.squeeze -= n * force;
      } else if (n.z() <= kDownwards) {
        pressing.push_back({&shape, p, -n * force});
      }
    }
  }
  if (pressing.empty()) return;
  const Vec3Array beneath = SamplesBeneath(pressing, x);
  for (const Pressing& at : pressing) {
    if (BorneByTable(beneath, at.p)) at.shape->squeeze += at.force;
  }
}

}  // namespace gusset
