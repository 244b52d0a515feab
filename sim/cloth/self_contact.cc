#include "sim/cloth/self_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sim/cloth/closest_points.h"
#include "sim/cloth/simd8.h"

namespace gusset {
namespace {

// Tuned 2026-11 for the least time over dragging, lifting and crumpling
// (docs/physics.md).
constexpr MotionForecast::Setting kFar = {0.025f, 0.001f, 0.3f, 0.004f};
constexpr MotionForecast::Setting kNear = {0.010f, 0.0003f, 0.2f, 0.0012f};
constexpr int kFarError = 0, kNearError = 1;
constexpr float kTrust = 0.8f;  // share of a margin after which a forecast is made anew
// A plane that separates by less than this share of the gap, as it is or as it was when the plane
// was placed, has turned or is slanting in the way of what slides past it, and is placed anew.
constexpr float kTilted = 0.8f;
// Two sweeps leave a stack some slip below Coulomb's limit. Contacts remember it, and this much of
// it is taken back in a second, a fifth in a substep at the default rate: all of it at once would
// keep a hanging bag trembling. Tuned 2026-11 (Rest, LayerFriction).
constexpr float kReturned_1_s = 120.0f;
constexpr float kMostReturned = 0.5f;
constexpr float kMostSlipped_m = 1e-4f;  // below what any camera or finger tells; tuned with it
// How fast what a contact keeps may change. Ridges and cones are looked at when contacts are
// selected, and cloth that is let fall by 0.3 mm then, and pushed up again the next time, shakes
// for seconds. Tuned 2026-11 (SelectingContactsAnewThrowsNoNodes, ComesToRest, and held layers that
// slip): dropped bags and folded ones have been slower than 3 mm/s for 0.15 s after 0.71 and 0.64 s
// at any rate, 0.39 and 0.54 s at 0.01 m/s, 0.31 and 0.47 s at 0.003 (32 each); but at 0.003 and
// 0.005 one bag that the tests drop, or hold, keeps shaking.
constexpr float kKeptRate_m_s = 0.01f;
constexpr int kSweeps = 5;  // over what was violated, before all are looked at again
constexpr int kLooks = 8;
constexpr int kAttempts = 4;
// Clearances below this never shrink: positions near 1 m are rounded to 6e-8 m.
constexpr float kLeastKept_m = 2e-5f;
// A push goes this much further than it must, so that what is lost to rounding comes back.
constexpr float kPushBeyond_m = 2e-6f;

Float4 Vector(const Vec4f& v) { return Float4::Load(v.data()); }

float Dot(Float4 a, Float4 b) { return Sum3(a * b); }

// Planes that leave less are pushed apart; nothing is taken from what never shrinks.
template <class F>
F AcceptedClearance(float thickness_m, F clear_m) {
  const F least = Min(0.1f * thickness_m, Max(clear_m * 0.5f, kLeastKept_m));
  return gusset::Select(clear_m <= kLeastKept_m, clear_m, least * 0.9f);
}

// Adds first + k for each bit k, those below count.
void List(int bits, std::size_t first, std::size_t count, std::vector<int>& out) {
  for (std::size_t i = first; bits != 0 && i < count; ++i, bits >>= 1) {
    if (bits & 1) out.push_back(static_cast<int>(i));
  }
}

}  // namespace

SelfContact::SelfContact(const ClothMesh& mesh, float friction)
    : mesh_(mesh), thickness_m_(mesh.thickness_m), friction_(friction), pair_search_(mesh) {}

void SelfContact::Invalidate() {
  ForgetForecasts();
  force_count_ = 0;  // what is elsewhere keeps nothing of before
}

void SelfContact::ForgetForecasts() {
  errors_known_ = false;
  far_.Invalidate();
  near_.Invalidate();
}

void SelfContact::Search(const Vec4Array& x, const Vec4Array& v) {
  far_.Start(kFar, x, v);
  pair_search_.Find(far_, node_triangle_, edge_edge_);
}

// Turns pairs that may meet within the near forecast into contacts.
void SelfContact::Select(const Vec4Array& x, const Vec4Array& v) {
  near_.Start(kNear, x, v);
  moves_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Float4 now = Vector(x[i]) - Vector(far_.start()[i]);
    Float8(now, now + Vector(near_.way()[i])).Store(moves_[i].now_end.data());
    moves_[i].now_end[7] = near_.way()[i][3];
  }
  kept_.Clear();
  for (std::size_t i = 0; i < force_count_; ++i) {
    if (contacts_[i].kept_m > 0) kept_.Note(contacts_[i].pair(), contacts_[i].kept_m);
  }
  kept_.Sort();
  contacts_.clear();
  guards_.clear();
  SelectFrom<false>(node_triangle_, x);
  SelectFrom<true>(edge_edge_, x);
  force_count_ = contacts_.size();
  pushed_.assign((force_count_ + 63) / 64, 0);
  slipped_.assign(force_count_, Vec4f::Zero());
  most_slipped_m_.assign(force_count_, 0.0f);
  contacts_.insert(contacts_.end(), guards_.begin(), guards_.end());
  planes_.resize((contacts_.size() + kLanes8 - 1) / kLanes8);
  for (std::size_t i = 0; i < kLanes8 * planes_.size(); ++i) SetPlane(i);
  ++selections_;
}

template <bool edges>
void SelfContact::SelectFrom(const Sieve<ElementPair>& pairs, const Vec4Array& x) {
  // The largest difference of two nodes' moves, one of each element, by component: an element's
  // points move by a mean of its nodes' moves, so this bounds the change of distance.
  const auto widest = [](const std::array<Float8, 4>& m) {
    const Float8 first = Max(Abs(m[0] - m[2]), Abs(m[0] - m[3]));
    if (edges) return Max(first, Max(Abs(m[1] - m[2]), Abs(m[1] - m[3])));
    return Max(first, Abs(m[0] - m[1]));
  };
  const auto moves = [&](const ElementPair& pair) {
    std::array<Float8, 4> m;
    for (int k = 0; k < 4; ++k) m[k] = Float8::Load(moves_[pair.node[k]].now_end.data());
    return m;
  };
  // Margins, in the last lane, add up the other way round.
  const auto margins = [](const std::array<Float8, 4>& m) {
    const Float4 last = Max(m[2].high(), m[3].high());
    return edges ? Max(m[0].high(), m[1].high()) + last : m[0].high() + Max(m[1].high(), last);
  };
  const float reach[2] = {thickness_m_, thickness_m_ * kGuardedShare};
  // Pairs whose distance can fall below what matters, four at a time.
  const Float4 xyz = Float4(1, 1, 1, 0) == Float4(1.0f);
  near_pairs_.Clear();
  near_pairs_.Expect(pairs.size() + 3);
  for (std::size_t i = 0; i < pairs.size(); i += 4) {
    const auto pair = [&](std::size_t k) -> const ElementPair& {
      return pairs[std::min(i + k, pairs.size() - 1)];
    };
    Float4 move[4];
    for (std::size_t k = 0; k < 4; ++k) {
      const std::array<Float8, 4> m = moves(pair(k));
      const Float8 wide = widest(m);
      move[k] = gusset::Select(xyz, Max(wide.low(), wide.high()), margins(m));
    }
    Transpose(move[0], move[1], move[2], move[3]);
    const Float4 move2 = move[0] * move[0] + move[1] * move[1] + move[2] * move[2];
    const Float4 distance(pair(0).distance_m, pair(1).distance_m, pair(2).distance_m,
                          pair(3).distance_m);
    const Float4 needed(reach[pair(0).guard], reach[pair(1).guard], reach[pair(2).guard],
                        reach[pair(3).guard]);
    const Float4 slack = distance - move[3] - needed;
    const int far = Bits((Float4(0.0f) < slack) & (move2 < slack * slack));
    for (std::size_t k = 0; k < 4; ++k) {
      near_pairs_.Offer(static_cast<int>(i + k), !(far >> k & 1) & (i + k < pairs.size()));
    }
  }
  picked_.clear();
  approach_m_.clear();
  for (std::size_t i = 0; i < near_pairs_.size(); ++i) {
    const ElementPair& pair = pairs[near_pairs_[i]];
    Contact c;
    c.node = pair.node;
    c.element = pair.element;
    c.edges = edges;
    c.kept_m = pair.guard ? 0.0f : thickness_m_;
    picked_.push_back(c);
    // From here on, only the near forecast's own way counts.
    std::array<Float8, 4> m = moves(pair);
    alignas(16) float margin[4];
    margins(m).Store(margin);
    for (Float8& of : m) of = HalvesSwapped(of) - of;
    const Float4 way = widest(m).low();
    approach_m_.push_back(std::sqrt(Dot(way, way)) + margin[3]);
  }
  if (picked_.empty()) return;
  for (std::size_t i = 0; i < picked_.size(); i += kLanes8) {
    std::array<Contact*, kLanes8> some;
    for (std::size_t k = 0; k < kLanes8; ++k) {
      some[k] = &picked_[std::min(i + k, picked_.size() - 1)];
    }
    Place(some, x);
  }
  if (edges) {
    KeepByRidges(x);
  } else {
    for (Contact& c : picked_) {
      if (c.kept_m > 0 && !IsClosest(c, x)) c.kept_m = 0;
    }
  }
  for (Contact& c : picked_) {
    c.goal_m = c.kept_m;
    if (c.gap_m < thickness_m_) c.kept_m = kept_.Find(c.pair(), c.kept_m);
  }
  for (std::size_t i = 0; i < picked_.size(); ++i) {
    const Contact& c = picked_[i];
    const float reach_m = std::max({c.kept_m, c.goal_m, thickness_m_ * kGuardedShare});
    if (c.gap_m > approach_m_[i] + reach_m) continue;
    (c.kept_m > 0 ? contacts_ : guards_).push_back(c);
  }
}

// Of a node against a triangle: false where another contact carries the force.
bool SelfContact::IsClosest(const Contact& c, const Vec4Array& x) const {
  const std::array<float, 3> at = {-c.weight[1], -c.weight[2], -c.weight[3]};
  const Facing& facing = pair_search_.facing();
  return facing.Owns(c.element[1], at) && facing.IsClosest(c.element[1], at, c.normal, x);
}

// Of the contacts picked, edge against edge: as far apart as both are ridges.
void SelfContact::KeepByRidges(const Vec4Array& x) {
  const auto ends = [](const Contact& c) {
    // An end of an edge is a node, and node against triangle carries its contact.
    return !(c.weight[0] > 0 && c.weight[1] > 0 && c.weight[2] < 0 && c.weight[3] < 0);
  };
  asked_.clear();
  for (Contact& c : picked_) {
    if (c.kept_m > 0 && ends(c)) c.kept_m = 0;
    if (c.kept_m > 0) asked_.push_back(&c);
  }
  // Both edges of four contacts at a time.
  constexpr std::size_t kContacts = kLanes8 / 2;
  for (std::size_t i = 0; i < asked_.size(); i += kContacts) {
    Facing::EdgeQuery query;
    for (std::size_t lane = 0; lane < kLanes8; ++lane) {
      const Contact& c = *asked_[std::min(i + lane / 2, asked_.size() - 1)];
      const float sign = lane % 2 == 0 ? -1.0f : 1.0f;
      query.edge[lane] = c.element[lane % 2];
      query.outwards_x[lane] = sign * c.normal[0];
      query.outwards_y[lane] = sign * c.normal[1];
      query.outwards_z[lane] = sign * c.normal[2];
    }
    pair_search_.facing().FindRidgeShares(x, query);
    for (std::size_t k = 0; k < kContacts && i + k < asked_.size(); ++k) {
      asked_[i + k]->kept_m = std::min(query.share[2 * k], query.share[2 * k + 1]) * thickness_m_;
    }
  }
}

// Closest points of eight pairs of one kind at x: weights, normal, distance.
void SelfContact::Place(const std::array<Contact*, kLanes8>& contacts, const Vec4Array& x) const {
  const auto at = [&](int k) {
    std::array<int, kLanes8> n;
    for (std::size_t lane = 0; lane < kLanes8; ++lane) n[lane] = contacts[lane]->node[k];
    return Gather(x.data(), n);
  };
  const Vec3x8 p0 = at(0), p1 = at(1), p2 = at(2), p3 = at(3);
  Float8 w0, w1, w2, w3;
  if (contacts[0]->edges) {
    const SegmentPoints<Float8> st = ClosestOnSegments(p0, p1, p2, p3);
    w0 = Float8(1.0f) - st.s;
    w1 = st.s;
    w2 = st.t - 1.0f;
    w3 = Float8(0.0f) - st.t;
  } else {
    const Barycentric<Float8> b = ClosestOnTriangle(p0, p1, p2, p3);
    w0 = 1.0f;
    w1 = Float8(0.0f) - b.a;
    w2 = Float8(0.0f) - b.b;
    w3 = Float8(0.0f) - b.c;
  }
  // Differences, not positions, are weighted: the weights' sum is zero, and far
  // from the origin the positions' rounding would show.
  const Vec3x8 gap = contacts[0]->edges ? (p0 - p2) + (p1 - p0) * w1 + (p3 - p2) * w3
                                        : (p0 - p1) + (p2 - p1) * w2 + (p3 - p1) * w3;
  const Float8 distance = Sqrt(Dot(gap, gap));
  const Vec3x8 normal = gap * (Float8(1.0f) / Max(distance, 1e-12f));
  Float8 rows[4] = {normal.x, normal.y, normal.z, Float8()};
  TransposeHalves(rows[0], rows[1], rows[2], rows[3]);
  TransposeHalves(w0, w1, w2, w3);
  const Float8 weights[4] = {w0, w1, w2, w3};
  alignas(32) float length[kLanes8];
  distance.Store(length);
  for (std::size_t k = 0; k < kLanes8; ++k) {
    Contact& c = *contacts[k];
    const bool low = k < 4;
    (low ? rows[k].low() : rows[k - 4].high()).Store(c.normal.data());
    Storeu(low ? weights[k].low() : weights[k - 4].high(), c.weight.data());
    c.gap_m = length[k];
    if (length[k] > 1e-9f) continue;
    // Touching exactly: any direction across the second element will do.
    const auto p = [&](int j) { return Vec3f(x[c.node[j]].head<3>()); };
    const Vec3f across =
        c.edges ? (p(1) - p(0)).cross(p(3) - p(2)) : (p(2) - p(1)).cross(p(3) - p(1));
    const float norm = across.norm();
    c.normal = Vec4f::UnitZ();
    if (norm > 0) c.normal.head<3>() = across / norm;
  }
}

// Copies what of a contact is looked at in every substep. Past the last contact: the last again.
void SelfContact::SetPlane(std::size_t contact) {
  const Contact& c = contacts_[std::min(contact, contacts_.size() - 1)];
  Planes& p = planes_[contact / kLanes8];
  const std::size_t k = contact % kLanes8;
  p.nx[k] = c.normal[0], p.ny[k] = c.normal[1], p.nz[k] = c.normal[2];
  p.w1[k] = c.weight[1], p.w2[k] = c.weight[2], p.w3[k] = c.weight[3];
  p.edges[k] = c.edges ? 1.0f : 0.0f;
  p.gap[k] = p.clear[k] = p.placed[k] = c.gap_m;
  alignas(16) float accepted[4];
  AcceptedClearance(thickness_m_, Float4(c.gap_m)).Store(accepted);
  p.accepted[k] = accepted[0];
  for (int j = 0; j < 4; ++j) p.node[j][k] = c.node[j];
}

namespace {

// Heights of contacts' nodes above their node 0, along their normals.
template <class Planes>
struct Heights {
  Float8 h1, h2, h3, edges;
  Heights(const Planes& p, const Vec4Array& x) {
    const auto at = [&](int k) { return Gather(x.data(), p.node[k]); };
    const Vec3x8 n = {Of(p.nx), Of(p.ny), Of(p.nz)}, p0 = at(0);
    h1 = Dot(n, at(1) - p0);
    h2 = Dot(n, at(2) - p0);
    h3 = Dot(n, at(3) - p0);
    edges = Float8(0.0f) < Of(p.edges);
  }
  // Lowest node of the first element over the highest of the second.
  Float8 Clearance() const {
    const Float8 low = Select(edges, Min(h1, 0.0f), 0.0f);
    return low - Max(Max(h2, h3), Select(edges, h2, h1));
  }
};

}  // namespace

// Gap and clearance of all contacts at the substep's start, where FindViolated last looked; planes
// that have turned are placed anew.
void SelfContact::Measure(const Vec4Array& x) {
  const std::size_t count = contacts_.size();
  violated_.clear();
  for (std::size_t g = 0; g < planes_.size(); ++g) {
    Planes& p = planes_[g];
    const Float8 gap = Of(p.end_gap), clear = Of(p.end_clear);
    gap.Store(p.gap.data());
    clear.Store(p.clear.data());
    AcceptedClearance(thickness_m_, clear).Store(p.accepted.data());
    List(Bits(clear < Max(gap, Of(p.placed)) * kTilted), kLanes8 * g, count, violated_);
  }
  std::array<Contact*, kLanes8> some{};
  for (const bool edges : {false, true}) {
    std::size_t filled = 0;
    const auto flush = [&] {
      if (filled == 0) return;
      for (std::size_t k = filled; k < kLanes8; ++k) some[k] = some[0];
      Place(some, x);
      for (std::size_t k = 0; k < filled; ++k) {
        const auto at = static_cast<std::size_t>(some[k] - contacts_.data());
        SetPlane(at);
        if (at < force_count_) slipped_[at].setZero();  // of other points
      }
      filled = 0;
    };
    for (const int i : violated_) {
      if (contacts_[i].edges != edges) continue;
      some[filled++] = &contacts_[i];
      if (filled == kLanes8) flush();
    }
    flush();
  }
}

void SelfContact::Prepare(const Vec4Array& x, const Vec4Array& v, float h, float separation_m) {
  if (!errors_known_) errors_ = MotionForecast::WorstErrors(far_, near_, x);
  errors_known_ = false;
  if (errors_[kFarError] > kTrust) {
    Search(x, v);
    Select(x, v);
  } else if (errors_[kNearError] > kTrust) {
    Select(x, v);
  } else {
    Measure(x);
  }
  far_.Age(h);
  near_.Age(h);
  returned_ = std::min(kReturned_1_s * h, kMostReturned);
  for (std::size_t i = 0; i < force_count_; ++i) {
    Contact& c = contacts_[i];
    c.gap_m = planes_[i / kLanes8].gap[i % kLanes8];
    c.kept_m += std::clamp(c.goal_m - c.kept_m, -kKeptRate_m_s * h, kKeptRate_m_s * h);
    c.target_m = std::min(c.kept_m, c.gap_m + separation_m);
  }
}

void SelfContact::Solve(const Vec4Array& x_prev, const std::vector<float>& inv_mass, Vec4Array& x) {
  for (std::size_t i = 0; i < force_count_; ++i) {
    Contact& c = contacts_[i];
    const auto& n = c.node;
    const Float4 s0 = c.weight[0], s1 = c.weight[1], s2 = c.weight[2], s3 = c.weight[3];
    const Float4 normal = Vector(c.normal);
    const Float4 gap =
        s0 * Vector(x[n[0]]) + s1 * Vector(x[n[1]]) + (s2 * Vector(x[n[2]]) + s3 * Vector(x[n[3]]));
    const float depth = c.target_m - Dot(normal, gap);
    if (depth <= 0) continue;
    pushed_[i / 64] |= std::uint64_t{1} << (i % 64);
    const auto& s = c.weight;
    const float w = s[0] * s[0] * inv_mass[n[0]] + s[1] * s[1] * inv_mass[n[1]] +
                    s[2] * s[2] * inv_mass[n[2]] + s[3] * s[3] * inv_mass[n[3]];
    // Coulomb friction on the slip of this substep (Mueller et al. 2007, section 3.5), and on some
    // of what earlier ones left.
    const Float4 slip3 = gap -
                         (s0 * Vector(x_prev[n[0]]) + s1 * Vector(x_prev[n[1]]) +
                          (s2 * Vector(x_prev[n[2]]) + s3 * Vector(x_prev[n[3]]))) +
                         Vector(slipped_[i]) * Float4(returned_);
    const Float4 slip = slip3 - normal * Float4(Dot(normal, slip3));
    const float slip2 = Dot(slip, slip);
    const float most = friction_ * depth;
    const float share = slip2 > most * most ? most / std::sqrt(slip2) : 1.0f;
    most_slipped_m_[i] = std::min(kMostSlipped_m, std::max(most_slipped_m_[i], most / returned_));
    const Float4 push = (normal * Float4(depth) - slip * Float4(share)) * Float4(1.0f / w);
    for (int k = 0; k < 4; ++k) {
      (Vector(x[n[k]]) + push * Float4(s[k] * inv_mass[n[k]])).Store(x[n[k]].data());
    }
  }
}

void SelfContact::EndSubstep(const std::vector<float>& inv_mass, float h, Vec4Array& v) {
  const auto pushed = [&](std::size_t i) { return pushed_[i / 64] >> (i % 64) & 1; };
  // Of node 0 to 3's velocities what the contact's gap changes by.
  const auto rate = [&](const Contact& c) {
    const auto& n = c.node;
    const auto& s = c.weight;
    return Float4(s[0]) * Vector(v[n[0]]) + Float4(s[1]) * Vector(v[n[1]]) +
           (Float4(s[2]) * Vector(v[n[2]]) + Float4(s[3]) * Vector(v[n[3]]));
  };
  for (std::size_t i = 0; i < force_count_; ++i) {
    if (!pushed(i)) {
      slipped_[i].setZero();
      continue;
    }
    const Float4 normal = Vector(contacts_[i].normal), all = rate(contacts_[i]);
    const Float4 slipped =
        Vector(slipped_[i]) + (all - normal * Float4(Dot(normal, all))) * Float4(h);
    // No more than friction could take back, or it would pull where nothing did.
    const float most = most_slipped_m_[i], slipped2 = Dot(slipped, slipped);
    const float kept = slipped2 > most * most ? most / std::sqrt(slipped2) : 1.0f;
    (slipped * Float4(kept)).Store(slipped_[i].data());
    most_slipped_m_[i] = 0;
  }
  for (std::size_t i = 0; i < force_count_; ++i) {
    const Contact& c = contacts_[i];
    if (!pushed(i) || c.gap_m >= c.kept_m) continue;
    const Float4 normal = Vector(c.normal);
    const float apart = Dot(normal, rate(c));
    if (apart <= 0) continue;
    const auto& n = c.node;
    const auto& s = c.weight;
    const float w = s[0] * s[0] * inv_mass[n[0]] + s[1] * s[1] * inv_mass[n[1]] +
                    s[2] * s[2] * inv_mass[n[2]] + s[3] * s[3] * inv_mass[n[3]];
    const Float4 pull = normal * Float4(-apart / w);
    for (int k = 0; k < 4; ++k) {
      (Vector(v[n[k]]) + pull * Float4(s[k] * inv_mass[n[k]])).Store(v[n[k]].data());
    }
  }
  std::fill(pushed_.begin(), pushed_.end(), 0);
}

// What must be left of a contact's clearance at the substep's end: no less than
// half of it, and nothing may be lost of the last micrometres.
float SelfContact::LeastClearance(float clear_m) const {
  if (clear_m <= kLeastKept_m) return clear_m;
  return std::min(0.1f * thickness_m_, std::max(0.5f * clear_m, kLeastKept_m));
}

// The extreme nodes' distance along the normal: positive while a plane
// separates the elements.
float SelfContact::Clearance(const Contact& c, const Vec4Array& x, int& first, int& second) const {
  std::array<float, 4> h{};
  for (int k = 1; k < 4; ++k) {
    h[k] = Dot(Vector(c.normal), Vector(x[c.node[k]]) - Vector(x[c.node[0]]));
  }
  int low = 0, high = 3;
  if (c.edges) {
    low = h[1] < 0 ? 1 : 0;
    high = h[3] > h[2] ? 3 : 2;
  } else {
    high = h[2] > h[1] ? 2 : 1;
    high = h[3] > h[high] ? 3 : high;
  }
  first = c.node[low];
  second = c.node[high];
  return h[low] - h[high];
}

// Lists contacts that have lost too much clearance at x.
bool SelfContact::FindViolated(const Vec4Array& x) {
  violated_.clear();
  const std::size_t count = contacts_.size();
  for (std::size_t g = 0; g < planes_.size(); ++g) {
    Planes& p = planes_[g];
    const Heights<Planes> h(p, x);
    const Float8 clear = h.Clearance();
    // The next substep starts from here.
    (h.h1 * Of(p.w1) + h.h2 * Of(p.w2) + h.h3 * Of(p.w3)).Store(p.end_gap.data());
    clear.Store(p.end_clear.data());
    List(Bits(clear < Of(p.accepted)), kLanes8 * g, count, violated_);
  }
  return !violated_.empty();
}

// Gauss-Seidel on violated planes. True if none is left.
bool SelfContact::PushApart(const std::vector<float>& inv_mass, Vec4Array& x) {
  for (int look = 0; look < kLooks; ++look) {
    bool pushed = true;
    for (int sweep = 0; sweep < kSweeps && pushed; ++sweep) {
      pushed = false;
      for (const int i : violated_) {
        const Contact& c = contacts_[i];
        int first, second;
        const float lack = LeastClearance(clear_m(i)) - Clearance(c, x, first, second);
        if (lack <= 0) continue;
        pushed = true;
        const Vec4f push =
            c.normal * ((lack + kPushBeyond_m) / (inv_mass[first] + inv_mass[second]));
        x[first] += push * inv_mass[first];
        x[second] -= push * inv_mass[second];
      }
    }
    if (!FindViolated(x)) return true;
  }
  return false;
}

// Nodes joined by a violated contact form a zone, which moves rigidly but for
// the share of its inner motion that its planes allow; zones grow until no
// plane is violated.
void SelfContact::MoveAsZones(const Vec4Array& x_prev, const std::vector<float>& inv_mass,
                              float floor_m, Vec4Array& x) {
  const std::size_t count = x.size();
  std::vector<int> zone(count);
  std::iota(zone.begin(), zone.end(), 0);
  const auto find = [&](std::size_t node) {
    int i = static_cast<int>(node);
    while (zone[i] != i) i = zone[i] = zone[zone[i]];
    return i;
  };
  const Vec4Array wanted = x;
  Vec4Array sum(count);
  std::vector<float> mass(count), lowest(count), share(count);
  std::vector<int> members(count);
  do {
    bool grew = false;
    for (const int i : violated_) {
      const int root = find(contacts_[i].node[0]);
      for (int k = 1; k < 4; ++k) {
        const int other = find(contacts_[i].node[k]);
        if (other == root) continue;
        zone[other] = root;
        grew = true;
      }
    }
    if (!grew) return;  // what is left is rounding within a zone
    // Mass-weighted mean displacement of each zone, none of its nodes lowered
    // below the floor.
    sum.assign(count, Vec4f::Zero());
    mass.assign(count, 0.0f);
    lowest.assign(count, std::numeric_limits<float>::lowest());
    share.assign(count, 1.0f);
    members.assign(count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const int root = find(i);
      sum[root] += (wanted[i] - x_prev[i]) / inv_mass[i];
      mass[root] += 1.0f / inv_mass[i];
      lowest[root] = std::max(lowest[root], std::min(floor_m - x_prev[i].z(), 0.0f));
      ++members[root];
    }
    // Clearance is a concave function of the nodes, clear_m at the rigid
    // motion: this share of the way to where they want to be leaves what must
    // be left.
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      const Contact& c = contacts_[i];
      const int root = find(c.node[0]);
      if (find(c.node[1]) != root || find(c.node[2]) != root || find(c.node[3]) != root) continue;
      int first, second;
      const float clear = Clearance(c, wanted, first, second);
      const float before = clear_m(i), least = LeastClearance(before);
      if (clear < least) share[root] = std::min(share[root], (before - least) / (before - clear));
    }
    for (std::size_t i = 0; i < count; ++i) {
      const int root = find(i);
      if (members[root] == 1) continue;
      Vec4f move = sum[root] / mass[root];
      move.z() = std::max(move.z(), lowest[root]);
      x[i] = x_prev[i] + move + (wanted[i] - x_prev[i] - move) * share[root];
    }
  } while (FindViolated(x));
}

// Contacts for the very motion from x_prev to x, which forecasts made earlier
// do not cover.
void SelfContact::SearchAlong(const Vec4Array& x_prev, const Vec4Array& x, float h, bool far) {
  v_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) v_[i] = (x[i] - x_prev[i]) / h;
  if (far) {
    Search(x_prev, v_);
    far_.Age(h);
  }
  Select(x_prev, v_);
  near_.Age(h);
}

void SelfContact::Enforce(const Vec4Array& x_prev, const std::vector<float>& inv_mass, float h,
                          float floor_m, Vec4Array& x) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    // The contacts are all there is to watch while the nodes keep to the
    // forecasts.
    if (!errors_known_) errors_ = MotionForecast::WorstErrors(far_, near_, x);
    const bool lost = errors_[kFarError] > 1.0f;
    errors_known_ = !lost && errors_[kNearError] <= 1.0f;
    if (!errors_known_) SearchAlong(x_prev, x, h, lost);
    if (!FindViolated(x)) return;
    if (!PushApart(inv_mass, x)) MoveAsZones(x_prev, inv_mass, floor_m, x);
    errors_ = MotionForecast::WorstErrors(far_, near_, x);
    errors_known_ = true;
    if (errors_[kFarError] <= 1.0f && errors_[kNearError] <= 1.0f) return;
  }
  // Corrections keep leading to new pairs: the whole cloth as one piece cannot
  // meet itself.
  Vec4f mean = Vec4f::Zero();
  float mass = 0, lowest = -1e9f;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean += (x[i] - x_prev[i]) / inv_mass[i];
    mass += 1.0f / inv_mass[i];
    lowest = std::max(lowest, std::min(floor_m - x_prev[i].z(), 0.0f));
  }
  mean /= mass;
  mean.z() = std::max(mean.z(), lowest);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = x_prev[i] + mean;
  ForgetForecasts();
}

int CountCrossings(const ClothMesh& mesh, const Vec3Array& x) {
  // In order of their least x, those that an edge may meet follow one another.
  struct Bounded {
    Vec3f lo, hi;
    int triangle;
  };
  std::vector<Bounded> bounded;
  bounded.reserve(mesh.triangles.size());
  float widest = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const Vec3f lo = x[t[0]].cwiseMin(x[t[1]]).cwiseMin(x[t[2]]);
    const Vec3f hi = x[t[0]].cwiseMax(x[t[1]]).cwiseMax(x[t[2]]);
    bounded.push_back({lo, hi, static_cast<int>(i)});
    widest = std::max(widest, hi.x() - lo.x());
  }
  const auto before = [](const Bounded& p, const Bounded& q) { return p.lo.x() < q.lo.x(); };
  std::sort(bounded.begin(), bounded.end(), before);
  int crossings = 0;
  for (const auto& e : mesh.edges) {
    const Vec3f &p = x[e[0]], &q = x[e[1]];
    const Vec3f lo = p.cwiseMin(q), hi = p.cwiseMax(q);
    const Bounded earliest{lo - Vec3f::Constant(1.001f * widest), hi, 0};
    for (auto at = std::lower_bound(bounded.begin(), bounded.end(), earliest, before);
         at != bounded.end() && at->lo.x() <= hi.x(); ++at) {
      if ((at->lo.array() > hi.array()).any() || (at->hi.array() < lo.array()).any()) continue;
      const auto& t = mesh.triangles[at->triangle];
      if (e[0] == t[0] || e[0] == t[1] || e[0] == t[2] || e[1] == t[0] || e[1] == t[1] ||
          e[1] == t[2]) {
        continue;
      }
      const Vec3f &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
      // Segment against triangle by signed volumes, in double: a crossing is a
      // yes or no.
      const auto volume = [](const Vec3f& o, const Vec3f& r, const Vec3f& s, const Vec3f& u) {
        const Eigen::Vector3d od = o.cast<double>();
        return (r.cast<double>() - od).cross(s.cast<double>() - od).dot(u.cast<double>() - od);
      };
      if ((volume(a, b, c, p) > 0) == (volume(a, b, c, q) > 0)) continue;
      const bool s1 = volume(p, q, a, b) > 0, s2 = volume(p, q, b, c) > 0,
                 s3 = volume(p, q, c, a) > 0;
      if (s1 == s2 && s2 == s3) ++crossings;
    }
  }
  return crossings;
}

}  // namespace gusset
