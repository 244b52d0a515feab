#include "sim/cloth/yarn_solver.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include "sim/cloth/packing.h"
#include "sim/cloth/simd8.h"

namespace gusset {
namespace {

// A link that is shorter than it may be by less may bear once the others of its yarn do: with none
// allowed for, rounding cuts loaded yarns in two, and nothing ever rests. Tuned 2026-11: with 2e-5
// a bag with the cube in it hangs restless (SleepingBagAndCube), with 3e-4 lumps may
// (RestAfterADrop).
constexpr float kNearlyTaut_m = 1e-4f;
// How much longer than at rest a link was at the substep's start is undone by halves: undone at
// once, it becomes speed, and lumps never come to rest. Tuned 2026-11 (RestAfterADrop): 0.4 and 0.6
// are worse, 0 never rests.
constexpr float kOldKept = 0.5f;
constexpr float kLeastLength_m = 1e-9f;

void Put(Float8 a, std::array<float, kLanes8>& lanes) { a.Store(lanes.data()); }

}  // namespace

YarnSolver::YarnSolver(std::vector<ClothYarn> yarns, std::vector<float> inv_mass)
    : yarns_(std::move(yarns)), inv_mass_(std::move(inv_mass)) {
  for (const ClothYarn& yarn : yarns_) {
    if (yarn.nodes.size() < 2) throw std::invalid_argument("YarnSolver: a yarn without a link");
  }
  std::vector<int> every(yarns_.size());
  std::iota(every.begin(), every.end(), 0);
  all_ = Pack(every);
  for (const Group& group : all_) rows_.resize(std::max(rows_.size(), group.places.size()));
}

std::vector<YarnSolver::Group> YarnSolver::Pack(const std::vector<int>& yarns) const {
  std::vector<std::span<const int>> chains;
  for (const int yarn : yarns) chains.emplace_back(yarns_[yarn].nodes);
  std::vector<Group> groups;
  for (const std::array<int, kLanes8>& eight : PackEights(chains, inv_mass_.size())) {
    Group& group = groups.emplace_back();
    group.places.resize(chains[eight[0]].size());
    for (std::size_t lane = 0; lane < kLanes8; ++lane) {
      group.count += eight[lane] >= 0;
      const ClothYarn& yarn = yarns_[yarns[eight[lane] < 0 ? eight[0] : eight[lane]]];
      group.rest_m[lane] = yarn.rest_m;
      for (std::size_t k = 0; k < yarn.nodes.size(); ++k) {
        group.places[k].node[lane] = static_cast<std::uint16_t>(yarn.nodes[k]);
        group.places[k].inv_mass[lane] = inv_mass_[yarn.nodes[k]];
      }
    }
  }
  return groups;
}

std::vector<YarnSolver::Group> YarnSolver::GroupsAt(const std::vector<bool>& nodes) const {
  std::vector<int> at;
  for (std::size_t i = 0; i < yarns_.size(); ++i) {
    bool any = false;
    for (const int n : yarns_[i].nodes) any = any || nodes[n];
    if (any) at.push_back(static_cast<int>(i));
  }
  return Pack(at);
}

void YarnSolver::Solve(float compliance, const std::vector<Group>& groups, const Vec4Array& x_prev,
                       Vec4Array& x) {
  for (const Group& group : groups) Solve(compliance, group, x_prev, x);
}

void YarnSolver::Solve(float compliance, const Group& group, const Vec4Array& x_prev,
                       Vec4Array& x) {
  if (!Measure(group, x_prev, x)) return;
  FindTensions(compliance, group);
  if (SlackenPushing(group.places.size() - 1)) FindTensions(compliance, group);
  Move(group, x);
}

// @returns whether any link is longer than it may be. A yarn without one does not pull.
bool YarnSolver::Measure(const Group& group, const Vec4Array& x_prev, const Vec4Array& x) {
  const Float8 rest = Of(group.rest_m);
  const auto& places = group.places;
  const std::size_t links = places.size() - 1;
  Float8 longest = -1.0f;
  Vec3x8 at = Gather(x.data(), places[0].node), was = Gather(x_prev.data(), places[0].node);
  Vec3x8 along_before;
  for (std::size_t j = 0; j <= links; ++j) {
    Row& row = rows_[j];
    Put(at.x, row.x), Put(at.y, row.y), Put(at.z, row.z);
    if (j == links) break;
    const Vec3x8 next = Gather(x.data(), places[j + 1].node);
    const Vec3x8 next_was = Gather(x_prev.data(), places[j + 1].node);
    const Vec3x8 way = next - at, way_was = next_was - was;
    const Float8 length = Sqrt(Dot(way, way));
    const Float8 old = Max(Sqrt(Dot(way_was, way_was)) - rest, 0.0f);
    const Float8 excess = length - rest - old * kOldKept;
    longest = Max(longest, excess);
    const Vec3x8 along = way * (Float8(1.0f) / Max(length, kLeastLength_m));
    Put(along.x, row.along_x), Put(along.y, row.along_y), Put(along.z, row.along_z);
    Put(excess, row.excess);
    Put(Of(places[j].inv_mass) * Dot(along_before, along), row.coupling);
    Put(Float8(-kNearlyTaut_m) < excess, row.pulls);
    at = next;
    was = next_was;
    along_before = along;
  }
  const Float8 longer = Float8(0.0f) < longest;
  for (std::size_t j = 0; j < links; ++j) Put(Of(rows_[j].pulls) & longer, rows_[j].pulls);
  return Bits(longer) != 0;
}

// With nodes moved by w (T a - T_before a_before), link j ends compliance T_j longer than at rest:
//   (w_j + w_j+1 + compliance) T_j - coupling_j T_j-1 - coupling_j+1 T_j+1 = excess_j,
// coupling_j = w_j a_j-1 . a_j; and T = 0 where a link does not pull. By Thomas's algorithm.
void YarnSolver::FindTensions(float compliance, const Group& group) {
  const std::size_t links = group.places.size() - 1;
  Float8 upper, right, pulls_before;
  for (std::size_t j = 0; j < links; ++j) {
    Row& row = rows_[j];
    const Float8 pulls = Of(row.pulls);
    const Float8 own = Of(group.places[j].inv_mass) + Of(group.places[j + 1].inv_mass) + compliance;
    const Float8 lower = Of(row.coupling) & pulls_before;
    const Float8 pivot = (Float8(1.0f) / (own - lower * upper)) & pulls;
    right = (Of(row.excess) + lower * right) * pivot;
    upper = j + 1 < links ? (Of(rows_[j + 1].coupling) & Of(rows_[j + 1].pulls)) * pivot : 0.0f;
    Put(upper, row.upper);
    Put(right, row.right);
    pulls_before = pulls;
  }
  Float8 tension;
  for (std::size_t j = links; j-- > 0;) {
    tension = Of(rows_[j].right) + Of(rows_[j].upper) * tension;
    Put(tension, rows_[j].tension);
  }
}

// @returns whether any did.
bool YarnSolver::SlackenPushing(std::size_t links) {
  int any = 0;
  for (std::size_t j = 0; j < links; ++j) {
    const Float8 pushes = Of(rows_[j].tension) < Float8(0.0f);
    any |= Bits(pushes);
    Put(Select(pushes, 0.0f, Of(rows_[j].pulls)), rows_[j].pulls);
  }
  return any != 0;
}

void YarnSolver::Move(const Group& group, Vec4Array& x) const {
  const std::size_t links = group.places.size() - 1;
  Vec3x8 pull_before;
  for (std::size_t j = 0; j <= links; ++j) {
    const Row& row = rows_[j];
    Vec3x8 pull;
    if (j < links) {
      // What still pushes, now that others do not, is left to the next pass.
      pull = Vec3x8{Of(row.along_x), Of(row.along_y), Of(row.along_z)} * Max(Of(row.tension), 0.0f);
    }
    const Vec3x8 moved = Vec3x8{Of(row.x), Of(row.y), Of(row.z)} +
                         (pull - pull_before) * Of(group.places[j].inv_mass);
    ForEachLane(moved, group.count, [&](std::size_t lane, Float4 at) {
      at.Store(x[group.places[j].node[lane]].data());
    });
    pull_before = pull;
  }
}

}  // namespace gusset
