#include "sim/cloth/bend_solver.h"

#include <algorithm>
#include <map>
#include <set>
#include <span>
#include <stdexcept>

#include "sim/cloth/packing.h"
#include "sim/cloth/simd8.h"

namespace gusset {
namespace {

// Internal friction before it slips, as a spring beside the elastic one: hysteresis loops of the
// KES-FB2 test turn within a quarter of their half width.
constexpr float kFrictionSpring = 4.0f;
// Below this second difference (m) a row's bend has no direction worth its name.
constexpr float kFlat_m = 4e-4f;
// Shortest waves stay below this share of what is stable.
constexpr double kStable = 0.98;

}  // namespace

// Rows begin at bends whose first two nodes are no bend's last two.
std::vector<BendSolver::Row> BendSolver::FindRows(const std::vector<ClothBend>& bends) {
  std::map<std::array<int, 2>, int> from;
  std::set<std::array<int, 2>> goes_on;
  for (std::size_t i = 0; i < bends.size(); ++i) {
    const ClothBend& b = bends[i];
    if (!from.emplace(std::array{b.a, b.mid}, static_cast<int>(i)).second) {
      throw std::invalid_argument("BendSolver: two bends begin with the same two nodes");
    }
    goes_on.insert({b.mid, b.c});
  }
  std::vector<Row> rows;
  std::size_t found = 0;
  for (const ClothBend& first : bends) {
    if (goes_on.contains({first.a, first.mid})) continue;
    Row& row = rows.emplace_back();
    row.nodes = {first.a, first.mid};
    for (auto at = from.find({first.a, first.mid}); at != from.end(); ++found) {
      const ClothBend& b = bends[at->second];
      row.bends.push_back(at->second);
      row.nodes.push_back(b.c);
      at = from.find({b.mid, b.c});
    }
  }
  if (found < bends.size()) throw std::invalid_argument("BendSolver: bends form a ring");
  return rows;
}

BendSolver::BendSolver(const std::vector<ClothBend>& bends, const std::vector<float>& inv_mass,
                       float h_s, float damping_s)
    : damping_s_(damping_s), ahead_(inv_mass.size()) {
  const std::vector<Row> rows = FindRows(bends);
  std::vector<int> rows_at(inv_mass.size(), 0);
  for (const Row& row : rows) {
    for (const int n : row.nodes) ++rows_at[n];
  }
  std::vector<float> share_kg;  // of a node's mass, for each row through it
  for (std::size_t i = 0; i < inv_mass.size(); ++i) {
    share_kg.push_back(1.0f / (inv_mass[i] * static_cast<float>(std::max(rows_at[i], 1))));
  }
  // A wave of frequency w is stable while (w h)^2 with friction's spring, which is as stiff until
  // it slips, and 2 h damping w^2 stay below 4 (Hairer, Lubich, Wanner 2006, I.1.4). With a mass
  // w^2 becomes w^2 / (1 + s w^2), and no row's w^2 is above Gershgorin's row sums.
  double fastest = 0;
  bool rubs = false;
  for (const Row& row : rows) {
    std::vector<double> row_sum(row.nodes.size(), 0.0);
    for (std::size_t k = 0; k < row.bends.size(); ++k) {
      const double stiffness = bends[row.bends[k]].stiffness_N_m;
      rubs = rubs || bends[row.bends[k]].friction_N > 0;
      for (int corner = 0; corner < 3; ++corner) {
        row_sum[k + corner] += (corner == 1 ? 8 : 4) * stiffness;
      }
    }
    for (std::size_t k = 0; k < row.nodes.size(); ++k) {
      fastest = std::max(fastest, row_sum[k] / share_kg[row.nodes[k]]);
    }
  }
  const double h = h_s;
  const double limit =
      kStable * 4 / (h * h * (1 + (rubs ? kFrictionSpring : 0.0f)) + 2 * h * damping_s);
  if (fastest > limit) scaling_s2_ = static_cast<float>(1 / limit - 1 / fastest);

  std::vector<std::span<const int>> chains;
  for (const Row& row : rows) chains.emplace_back(row.nodes);
  for (const std::array<int, kLanes8>& eight : PackEights(chains, inv_mass.size())) {
    Group& group = groups_.emplace_back();
    group.places.resize(rows[eight[0]].nodes.size());
    solved_.resize(std::max(solved_.size(), group.places.size()));
    for (std::size_t lane = 0; lane < kLanes8; ++lane) {
      group.count += eight[lane] >= 0;
      const Row& row = rows[eight[lane] < 0 ? eight[0] : eight[lane]];
      for (std::size_t k = 0; k < row.nodes.size(); ++k) {
        Place& place = group.places[k];
        place.node[lane] = static_cast<std::uint16_t>(row.nodes[k]);
        place.inv_rows[lane] = 1.0f / static_cast<float>(rows_at[row.nodes[k]]);
        if (k >= row.bends.size()) continue;
        const ClothBend& b = bends[row.bends[k]];
        place.bend[lane] = static_cast<std::uint16_t>(row.bends[k]);
        place.stiffness[lane] = b.stiffness_N_m;
        place.most[lane] = b.friction_N / (kFrictionSpring * b.stiffness_N_m);
      }
      Factor(bends, row, share_kg, lane, group.places);
    }
  }
}

// L D L^T of a row's M + s K.
void BendSolver::Factor(const std::vector<ClothBend>& bends, const Row& row,
                        const std::vector<float>& share_kg, std::size_t lane,
                        std::vector<Place>& places) const {
  const std::size_t count = row.nodes.size();
  struct Line {
    double diagonal, next = 0, next_but_one = 0;
  };
  std::vector<Line> lines;
  for (const int n : row.nodes) lines.push_back({share_kg[n]});
  for (std::size_t k = 0; k < row.bends.size(); ++k) {
    const double s = double{scaling_s2_} * bends[row.bends[k]].stiffness_N_m;
    lines[k].diagonal += s;
    lines[k + 1].diagonal += 4 * s;
    lines[k + 2].diagonal += s;
    lines[k].next -= 2 * s;
    lines[k + 1].next -= 2 * s;
    lines[k].next_but_one += s;
  }
  std::vector<double> pivot(count);
  std::vector<double> lower_1(count, 0.0), lower_2(count, 0.0);
  for (std::size_t k = 0; k < count; ++k) {
    double next = k >= 1 ? lines[k - 1].next : 0;
    if (k >= 2) {
      lower_2[k] = lines[k - 2].next_but_one / pivot[k - 2];
      next -= lower_2[k] * pivot[k - 2] * lower_1[k - 1];
    }
    if (k >= 1) lower_1[k] = next / pivot[k - 1];
    pivot[k] = lines[k].diagonal;
    if (k >= 1) pivot[k] -= lower_1[k] * lower_1[k] * pivot[k - 1];
    if (k >= 2) pivot[k] -= lower_2[k] * lower_2[k] * pivot[k - 2];
    places[k].inv_pivot[lane] = static_cast<float>(1 / pivot[k]);
    places[k].lower_1[lane] = static_cast<float>(lower_1[k]);
    places[k].lower_2[lane] = static_cast<float>(lower_2[k]);
  }
}

void BendSolver::Apply(float h, const Vec4Array& x, std::vector<float>& set, Vec4Array& v) {
  // Where the nodes would be a damping time later: its second difference holds both parts.
  for (std::size_t i = 0; i < x.size(); ++i) ahead_[i] = x[i] + damping_s_ * v[i];
  for (const Group& group : groups_) Apply(h, group, x, set, v);
}

void BendSolver::Apply(float h, const Group& group, const Vec4Array& x, std::vector<float>& set,
                       Vec4Array& v) {
  const std::vector<Place>& places = group.places;
  const std::size_t count = places.size();
  Vec3x8 now_1 = Gather(x.data(), places[0].node), later_1 = Gather(ahead_.data(), places[0].node);
  Vec3x8 now_2 = Gather(x.data(), places[1].node), later_2 = Gather(ahead_.data(), places[1].node);
  Vec3x8 pull_1, pull_2;      // of the bends that began one and two nodes before
  Vec3x8 solved_1, solved_2;  // forwards: L y = force
  for (std::size_t k = 0; k < count; ++k) {
    const Place& p = places[k];
    Vec3x8 pull;
    if (k + 2 < count) {
      const Vec3x8 now_3 = Gather(x.data(), places[k + 2].node);
      const Vec3x8 later_3 = Gather(ahead_.data(), places[k + 2].node);
      const Vec3x8 later = later_1 - later_2 * 2.0f + later_3, now = now_1 - now_2 * 2.0f + now_3;
      const Float8 bent = Sqrt(Dot(now, now)), most = Of(p.most);
      alignas(32) Lanes held;
      for (std::size_t lane = 0; lane < kLanes8; ++lane) held[lane] = set[p.bend[lane]];
      const Float8 holds = Min(Max(Of(held), bent - most), bent + most);
      holds.Store(held.data());
      for (std::size_t lane = 0; lane < kLanes8; ++lane) set[p.bend[lane]] = held[lane];
      const Float8 rubs = Of(p.stiffness) * kFrictionSpring * (bent - holds) / (bent + kFlat_m);
      pull = later * Of(p.stiffness) + now * rubs;
      now_1 = now_2, now_2 = now_3;
      later_1 = later_2, later_2 = later_3;
    }
    const Vec3x8 force = pull_1 * 2.0f - pull_2 - pull;
    const Vec3x8 y = force - solved_1 * Of(p.lower_1) - solved_2 * Of(p.lower_2);
    y.x.Store(solved_[k].x.data()), y.y.Store(solved_[k].y.data()), y.z.Store(solved_[k].z.data());
    pull_2 = pull_1, pull_1 = pull;
    solved_2 = solved_1, solved_1 = y;
  }
  Vec3x8 after_1, after_2;  // backwards: D L^T z = y
  Float8 lower_1, lower_2, lower_2_after;
  for (std::size_t k = count; k-- > 0;) {
    const Place& p = places[k];
    const Vec3x8 y = {Of(solved_[k].x), Of(solved_[k].y), Of(solved_[k].z)};
    const Vec3x8 z = y * Of(p.inv_pivot) - after_1 * lower_1 - after_2 * lower_2;
    const Vec3x8 gained = z * (Of(p.inv_rows) * h);
    ForEachLane(gained, group.count, [&](std::size_t lane, Float4 more) {
      Vec4f& of = v[p.node[lane]];
      (Float4::Load(of.data()) + more).Store(of.data());
    });
    after_2 = after_1, after_1 = z;
    lower_1 = Of(p.lower_1);
    lower_2 = lower_2_after;  // of the node after the next, to this one
    lower_2_after = Of(p.lower_2);
  }
}

}  // namespace gusset
