#include "sim/cloth/self_contact.h"

#include <cmath>
#include <numeric>
#include <set>

#include "sim/cloth/closest_points.h"

namespace gusset {
namespace {

// A node's margin covers this much time at its present speed, plus a base that covers what gravity
// and contact change meanwhile. Tuned 2026-11 for the least time per second of dragging.
constexpr float kMarginTime_s = 0.008f;
constexpr float kBaseMargin_m = 0.0007f;
constexpr float kMostMargin_m = 0.02f;
// Corrections within a substep stay below this, or Enforce looks at all pairs again.
constexpr float kSlop_m = 0.0004f;
constexpr int kSweeps = 6;
// Share of its margin by which a node must be beside a triangle to leave the force to a neighbour.
constexpr float kGuardTolerance = 0.5f;

Vec3f MeanMotion(const Vec3Array& x, const Vec3Array& x0) {
  Vec3f sum = Vec3f::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] - x0[i];
  return sum / static_cast<float>(x.size());
}

}  // namespace

SelfContact::SelfContact(const ClothMesh& mesh, float friction)
    : mesh_(mesh), thickness_m_(mesh.thickness_m), friction_(friction) {
  const int rows = static_cast<int>(mesh.patch_rows.size()) / mesh.layers;
  columns_ = static_cast<int>(mesh.patch_rows.front().size());
  for (const auto& row : mesh.patch_rows) {
    for (const ClothPatch& patch : row) {
      patches_.push_back(patch);
      std::array<int, 4> corner{};
      const auto& t0 = mesh.triangles[patch.triangles[0]];
      const auto& t1 = mesh.triangles[patch.triangles[1]];
      corner = {t0[0], t0[1], t0[2], t1[0]};
      for (const int n : t1) {
        if (n != t0[0] && n != t0[1] && n != t0[2]) corner[3] = n;
      }
      corner_.push_back(corner);
    }
  }
  for (int layer = 0; layer < mesh.layers; ++layer) {
    roots_.push_back(BuildTree(layer * rows, (layer + 1) * rows, 0, columns_));
  }
  std::vector<char> corner_owned(mesh.rest.size(), 0);
  std::set<std::array<int, 2>> edge_owned;
  for (const auto& t : mesh.triangles) {
    std::uint8_t owned = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3];
      if (!corner_owned[a]) owned |= static_cast<std::uint8_t>(1 << k);
      corner_owned[a] = 1;
      if (edge_owned.insert({std::min(a, b), std::max(a, b)}).second) {
        owned |= static_cast<std::uint8_t>(8 << k);
      }
    }
    owned_.push_back(owned);
  }
  margin_m_.assign(mesh.rest.size(), 0.0f);
  move_m_.assign(mesh.rest.size(), 0.0f);
  step_m_.assign(mesh.rest.size(), 0.0f);
}

int SelfContact::BuildTree(int row0, int row1, int col0, int col1) {
  TreeNode node;
  if (row1 - row0 == 1 && col1 - col0 == 1) {
    node.patch = row0 * columns_ + col0;
  } else if (row1 - row0 >= col1 - col0) {
    const int mid = (row0 + row1) / 2;
    node.left = BuildTree(row0, mid, col0, col1);
    node.right = BuildTree(mid, row1, col0, col1);
  } else {
    const int mid = (col0 + col1) / 2;
    node.left = BuildTree(row0, row1, col0, mid);
    node.right = BuildTree(row0, row1, mid, col1);
  }
  tree_.push_back(node);
  return static_cast<int>(tree_.size()) - 1;
}

void SelfContact::Box::Set(const Vec3f& low, const Vec3f& high, float grow) {
  lo << low.x() - grow, low.y() - grow, low.z() - grow, 0.0f;
  hi << high.x() + grow, high.y() + grow, high.z() + grow, 0.0f;
}

// Boxes of elements, each grown by half a thickness and its own margin, and of the tree above them.
void SelfContact::Refit(const Vec3Array& x) {
  const float half = 0.5f * thickness_m_;
  node_box_.resize(x.size());
  for (std::size_t i = 0; i < x.size(); ++i) node_box_[i].Set(x[i], x[i], half + margin_m_[i]);
  edge_box_.resize(mesh_.edges.size());
  for (std::size_t i = 0; i < mesh_.edges.size(); ++i) {
    const auto& e = mesh_.edges[i];
    edge_box_[i].Set(x[e[0]].cwiseMin(x[e[1]]), x[e[0]].cwiseMax(x[e[1]]),
                     half + std::max(margin_m_[e[0]], margin_m_[e[1]]));
  }
  triangle_box_.resize(mesh_.triangles.size());
  for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
    const auto& t = mesh_.triangles[i];
    triangle_box_[i].Set(x[t[0]].cwiseMin(x[t[1]]).cwiseMin(x[t[2]]),
                         x[t[0]].cwiseMax(x[t[1]]).cwiseMax(x[t[2]]),
                         half + std::max(margin_m_[t[0]], std::max(margin_m_[t[1]],
                                                                   margin_m_[t[2]])));
  }
  for (TreeNode& node : tree_) {
    const Box& a = node.patch >= 0 ? triangle_box_[patches_[node.patch].triangles[0]]
                                   : tree_[node.left].box;
    const Box& b = node.patch >= 0 ? triangle_box_[patches_[node.patch].triangles[1]]
                                   : tree_[node.right].box;
    node.box.lo = a.lo.min(b.lo);
    node.box.hi = a.hi.max(b.hi);
  }
}

void SelfContact::Detect(const Vec3Array& x, const Vec3Array& v) {
  Vec3f mean = Vec3f::Zero();
  for (const Vec3f& vi : v) mean += vi;
  mean /= static_cast<float>(v.size());
  for (std::size_t i = 0; i < x.size(); ++i) {
    margin_m_[i] = std::min(kBaseMargin_m + kMarginTime_s * (v[i] - mean).norm(), kMostMargin_m);
  }
  detected_x_ = x;
  pairs_.clear();
  Refit(x);
  for (std::size_t i = 0; i < roots_.size(); ++i) {
    SelfPairs(roots_[i], x);
    for (std::size_t j = i + 1; j < roots_.size(); ++j) CrossPairs(roots_[i], roots_[j], x);
  }
  valid_ = true;
  ++detections_;
}

void SelfContact::SelfPairs(int node, const Vec3Array& x) {
  const TreeNode& n = tree_[node];
  if (n.patch >= 0) return;
  SelfPairs(n.left, x);
  SelfPairs(n.right, x);
  CrossPairs(n.left, n.right, x);
}

void SelfContact::CrossPairs(int a, int b, const Vec3Array& x) {
  const TreeNode& na = tree_[a];
  const TreeNode& nb = tree_[b];
  if (!na.box.Overlaps(nb.box)) return;
  if (na.patch >= 0 && nb.patch >= 0) {
    PatchPairs(patches_[na.patch], patches_[nb.patch], x);
  } else if (nb.patch >= 0 || (na.patch < 0 && a > b)) {
    CrossPairs(na.left, b, x);
    CrossPairs(na.right, b, x);
  } else {
    CrossPairs(a, nb.left, x);
    CrossPairs(a, nb.right, x);
  }
}

void SelfContact::PatchPairs(const ClothPatch& a, const ClothPatch& b, const Vec3Array& x) {
  for (const int n : a.nodes) {
    for (const int t : b.triangles) {
      if (node_box_[n].Overlaps(triangle_box_[t])) AddNodeTriangle(n, t, x);
    }
  }
  for (const int n : b.nodes) {
    for (const int t : a.triangles) {
      if (node_box_[n].Overlaps(triangle_box_[t])) AddNodeTriangle(n, t, x);
    }
  }
  for (const int e : a.edges) {
    for (const int f : b.edges) {
      if (edge_box_[e].Overlaps(edge_box_[f])) AddEdgeEdge(e, f, x);
    }
  }
}

void SelfContact::AddNodeTriangle(int node, int triangle, const Vec3Array& x) {
  const auto& t = mesh_.triangles[triangle];
  if (node == t[0] || node == t[1] || node == t[2]) return;
  const float reach = thickness_m_ + margin_m_[node] +
                      std::max(margin_m_[t[0]], std::max(margin_m_[t[1]], margin_m_[t[2]]));
  const Vec3f& p = x[node];
  const Vec3f b = ClosestOnTriangle(p, x[t[0]], x[t[1]], x[t[2]]);
  const Vec3f gap = p - b[0] * x[t[0]] - b[1] * x[t[1]] - b[2] * x[t[2]];
  const float d = gap.norm();
  if (d > reach) return;
  // A border point that other triangles share stays theirs while the node cannot get over this one.
  bool guard = !Owns(triangle, b);
  if (guard) {
    const Vec3f normal = (x[t[1]] - x[t[0]]).cross(x[t[2]] - x[t[0]]);
    const float off = gap.dot(normal) / std::max(normal.norm(), 1e-12f);
    const float beside = std::sqrt(std::max(0.0f, d * d - off * off));
    guard = beside > kGuardTolerance * (reach - thickness_m_);
  }
  pairs_.push_back({{static_cast<std::uint16_t>(node), static_cast<std::uint16_t>(t[0]),
                     static_cast<std::uint16_t>(t[1]), static_cast<std::uint16_t>(t[2])},
                    d,
                    false,
                    guard,
                    static_cast<std::uint16_t>(triangle)});
}

void SelfContact::AddEdgeEdge(int e, int f, const Vec3Array& x) {
  const auto& a = mesh_.edges[e];
  const auto& b = mesh_.edges[f];
  if (a[0] == b[0] || a[0] == b[1] || a[1] == b[0] || a[1] == b[1]) return;
  const float reach = thickness_m_ + std::max(margin_m_[a[0]], margin_m_[a[1]]) +
                      std::max(margin_m_[b[0]], margin_m_[b[1]]);
  const Vec3f &p0 = x[a[0]], &p1 = x[a[1]], &q0 = x[b[0]], &q1 = x[b[1]];
  const Eigen::Vector2f st = ClosestOnSegments(p0, p1, q0, q1);
  const float d = (p0 + st[0] * (p1 - p0) - q0 - st[1] * (q1 - q0)).norm();
  if (d > reach) return;
  pairs_.push_back({{static_cast<std::uint16_t>(a[0]), static_cast<std::uint16_t>(a[1]),
                     static_cast<std::uint16_t>(b[0]), static_cast<std::uint16_t>(b[1])},
                    d,
                    true,
                    st[0] <= 0 || st[0] >= 1 || st[1] <= 0 || st[1] >= 1,
                    0});
}

// True if `triangle` is the one that carries a contact at this point of it.
bool SelfContact::Owns(int triangle, const Vec3f& b) const {
  const int zeros = (b[0] <= 0) + (b[1] <= 0) + (b[2] <= 0);
  if (zeros == 0) return true;
  for (int k = 0; k < 3; ++k) {
    if (zeros == 2 && b[k] > 0) return owned_[triangle] >> k & 1;
    if (zeros == 1 && b[(k + 2) % 3] <= 0) return owned_[triangle] >> (3 + k) & 1;
  }
  return true;
}

bool SelfContact::Stale(const Vec3Array& x) const {
  if (!valid_) return true;
  const Vec3f mean = MeanMotion(x, detected_x_);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const float limit = 0.7f * margin_m_[i];
    if ((x[i] - detected_x_[i] - mean).squaredNorm() > limit * limit) return true;
  }
  return false;
}

void SelfContact::UpdateMoves(const Vec3Array& x) {
  const Vec3f mean = MeanMotion(x, detected_x_);
  for (std::size_t i = 0; i < x.size(); ++i) move_m_[i] = (x[i] - detected_x_[i] - mean).norm();
}

// The pair's distance cannot be less than this now: each element moved by at most its nodes' moves.
float SelfContact::LeastDistance(const Pair& pair) const {
  const float m0 = move_m_[pair.node[0]], m1 = move_m_[pair.node[1]];
  const float m2 = move_m_[pair.node[2]], m3 = move_m_[pair.node[3]];
  const float moved =
      pair.edges ? std::max(m0, m1) + std::max(m2, m3) : m0 + std::max(m1, std::max(m2, m3));
  return pair.distance_m - moved;
}

SelfContact::Contact SelfContact::MakeContact(const Pair& pair, const Vec3Array& x_prev,
                                              float separation_m) const {
  Contact c;
  for (int k = 0; k < 4; ++k) c.node[k] = pair.node[k];
  c.edges = pair.edges;
  c.guard = pair.guard;
  const Vec3f &x0 = x_prev[c.node[0]], &x1 = x_prev[c.node[1]], &x2 = x_prev[c.node[2]],
              &x3 = x_prev[c.node[3]];
  Vec3f first;
  if (pair.edges) {
    const Eigen::Vector2f st = ClosestOnSegments(x0, x1, x2, x3);
    c.weight = {1 - st[0], st[0], st[1] - 1, -st[1]};
    // An end of an edge is a node, and node against triangle carries its contact.
    c.guard = st[0] <= 0 || st[0] >= 1 || st[1] <= 0 || st[1] >= 1;
    first = x0 + st[0] * (x1 - x0);
    c.origin = x2 + st[1] * (x3 - x2);
  } else {
    const Vec3f b = ClosestOnTriangle(x0, x1, x2, x3);
    c.weight = {1, -b[0], -b[1], -b[2]};
    c.guard = !Owns(pair.triangle, b);
    first = x0;
    c.origin = b[0] * x1 + b[1] * x2 + b[2] * x3;
  }
  const Vec3f gap = first - c.origin;
  c.distance_m = gap.norm();
  if (c.distance_m > 1e-9f) {
    c.normal = gap / c.distance_m;
  } else {  // touching exactly: any direction across the second element will do
    const Vec3f across = pair.edges ? (x1 - x0).cross(x3 - x2) : (x2 - x1).cross(x3 - x1);
    c.normal = across.norm() > 0 ? Vec3f(across.normalized()) : Vec3f(Vec3f::UnitZ());
  }
  c.target_m = std::min(thickness_m_, c.distance_m + separation_m);
  return c;
}

void SelfContact::Prepare(const Vec3Array& x_prev, const Vec3Array& x, float separation_m) {
  UpdateMoves(x);
  contacts_.clear();
  has_contact_.assign(pairs_.size(), 0);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (pairs_[i].guard || LeastDistance(pairs_[i]) > thickness_m_ + kSlop_m) continue;
    const Contact c = MakeContact(pairs_[i], x_prev, separation_m);
    if (c.guard) continue;
    has_contact_[i] = 1;
    contacts_.push_back(c);
  }
  force_count_ = contacts_.size();
}

void SelfContact::Solve(const Vec3Array& x_prev, const std::vector<float>& inv_mass, Vec3Array& x) {
  for (std::size_t i = 0; i < force_count_; ++i) {
    const Contact& c = contacts_[i];
    const auto& n = c.node;
    const auto& s = c.weight;
    const Vec3f gap = s[0] * x[n[0]] + s[1] * x[n[1]] + s[2] * x[n[2]] + s[3] * x[n[3]];
    const float depth = c.target_m - c.normal.dot(gap);
    if (depth <= 0) continue;
    const float w = s[0] * s[0] * inv_mass[n[0]] + s[1] * s[1] * inv_mass[n[1]] +
                    s[2] * s[2] * inv_mass[n[2]] + s[3] * s[3] * inv_mass[n[3]];
    // Coulomb friction on the slip of this substep (Mueller et al. 2007, section 3.5).
    const Vec3f slip3 = gap - s[0] * x_prev[n[0]] - s[1] * x_prev[n[1]] - s[2] * x_prev[n[2]] -
                        s[3] * x_prev[n[3]];
    const Vec3f slip = slip3 - c.normal * c.normal.dot(slip3);
    const float slip_m = slip.norm();
    const float most = friction_ * depth;
    const float share = slip_m > most ? most / slip_m : 1.0f;
    const Vec3f push = (c.normal * depth - slip * share) / w;
    for (int k = 0; k < 4; ++k) x[n[k]] += push * (s[k] * inv_mass[n[k]]);
  }
}

// True if the substep's motion is too short to bring the pair near a crossing.
bool SelfContact::CannotCross(const Contact& c) const {
  const auto& n = c.node;
  const float first = c.edges ? std::max(step_m_[n[0]], step_m_[n[1]]) : step_m_[n[0]];
  const float second = c.edges ? std::max(step_m_[n[2]], step_m_[n[3]])
                               : std::max(step_m_[n[1]], std::max(step_m_[n[2]], step_m_[n[3]]));
  return 0.5f * c.distance_m > first + second && 0.9f * c.distance_m - first - second > 0.1f * thickness_m_;
}

// Distance between the extreme nodes of the two elements along the normal: positive while a plane
// separates them.
float SelfContact::Clearance(const Contact& c, const Vec3Array& x, int& first, int& second) const {
  float h[4];
  for (int k = 0; k < 4; ++k) h[k] = c.normal.dot(x[c.node[k]] - c.origin);
  int lo = 0, hi;
  if (c.edges) {
    lo = h[1] < h[0] ? 1 : 0;
    hi = h[3] > h[2] ? 3 : 2;
  } else {
    hi = h[2] > h[1] ? 2 : 1;
    hi = h[3] > h[hi] ? 3 : hi;
  }
  first = c.node[lo];
  second = c.node[hi];
  return h[lo] - h[hi];
}

void SelfContact::Enforce(const Vec3Array& x_prev, const std::vector<float>& inv_mass,
                          float floor_m, Vec3Array& x) {
  // No node may leave the margin its pairs were searched with.
  const Vec3f mean = MeanMotion(x, detected_x_);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vec3f move = x[i] - detected_x_[i] - mean;
    const float length = move.norm();
    if (length > margin_m_[i]) x[i] -= move * (1.0f - margin_m_[i] / length);
  }
  // Pairs that carried no force but may have come close to crossing.
  UpdateMoves(x);
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    if (has_contact_[i] || LeastDistance(pairs_[i]) > 0.2f * thickness_m_) continue;
    contacts_.push_back(MakeContact(pairs_[i], x_prev, 0));
  }
  const Vec3f step = MeanMotion(x, x_prev);
  for (std::size_t i = 0; i < x.size(); ++i) step_m_[i] = (x[i] - x_prev[i] - step).norm();
  int first, second;
  const auto least = [&](const Contact& c) {
    return std::min(0.1f * thickness_m_, 0.5f * c.distance_m);
  };
  bool crossing = true;
  for (int sweep = 0; sweep < kSweeps && crossing; ++sweep) {
    crossing = false;
    for (const Contact& c : contacts_) {
      if (sweep == 0 && CannotCross(c)) continue;
      const float lack = least(c) - Clearance(c, x, first, second);
      if (lack <= 0) continue;
      crossing = true;
      const float w = inv_mass[first] + inv_mass[second];
      const Vec3f push = c.normal * ((1.02f * lack + 1e-7f) / w);
      x[first] += push * inv_mass[first];
      x[second] -= push * inv_mass[second];
    }
  }
  if (!crossing) return;

  // Rigid zones: nodes joined by a violated pair share one displacement; zones grow until none is.
  std::vector<int> zone(x.size());
  std::iota(zone.begin(), zone.end(), 0);
  const auto find = [&](int i) {
    while (zone[i] != i) i = zone[i] = zone[zone[i]];
    return i;
  };
  Vec3Array moved = x;
  for (int round = 0; round < 100; ++round) {
    bool grew = false;
    for (const Contact& c : contacts_) {
      if (Clearance(c, x, first, second) >= 0.9f * least(c)) continue;
      const int root = find(c.node[0]);
      for (int k = 1; k < 4; ++k) {
        const int other = find(c.node[k]);
        if (other != root) {
          zone[other] = root;
          grew = true;
        }
      }
    }
    if (!grew) break;
    ++zones_;
    // Mass-weighted mean displacement of each zone, none of its nodes below the floor.
    std::vector<Vec3f> sum(x.size(), Vec3f::Zero());
    std::vector<float> mass(x.size(), 0.0f), up(x.size(), -1e9f);
    for (std::size_t i = 0; i < x.size(); ++i) {
      const int root = find(static_cast<int>(i));
      sum[root] += (moved[i] - x_prev[i]) / inv_mass[i];
      mass[root] += 1.0f / inv_mass[i];
      up[root] = std::max(up[root], std::min(floor_m - x_prev[i].z(), 0.0f));
    }
    for (std::size_t i = 0; i < x.size(); ++i) {
      const int root = find(static_cast<int>(i));
      if (root == static_cast<int>(i) && mass[root] == 1.0f / inv_mass[i]) continue;  // alone
      Vec3f d = sum[root] / mass[root];
      d.z() = std::max(d.z(), up[root]);
      x[i] = x_prev[i] + d;
    }
  }
}

int CountCrossings(const ClothMesh& mesh, const Vec3Array& x) {
  int crossings = 0;
  for (const auto& e : mesh.edges) {
    const Vec3f &p = x[e[0]], &q = x[e[1]];
    const Vec3f lo = p.cwiseMin(q), hi = p.cwiseMax(q);
    for (const auto& t : mesh.triangles) {
      if (e[0] == t[0] || e[0] == t[1] || e[0] == t[2] || e[1] == t[0] || e[1] == t[1] ||
          e[1] == t[2]) {
        continue;
      }
      const Vec3f &a = x[t[0]], &b = x[t[1]], &c = x[t[2]];
      if ((a.cwiseMin(b).cwiseMin(c).array() > hi.array()).any() ||
          (a.cwiseMax(b).cwiseMax(c).array() < lo.array()).any()) {
        continue;
      }
      // Segment against triangle by signed volumes, in double: a crossing is a yes or no.
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
