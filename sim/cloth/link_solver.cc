#include "sim/cloth/link_solver.h"

#include <algorithm>
#include <list>
#include <set>
#include <stdexcept>
#include <type_traits>

#include "sim/cloth/packing.h"

namespace gusset {
namespace {

constexpr int kLookAhead = 64;  // links looked through for one that shares no node with its packet

}  // namespace

LinkSolver::LinkSolver(const std::vector<ClothLink>& links, const std::vector<float>& inv_mass) {
  // The order of links, four that share no node at a time.
  std::list<ClothLink> open(links.begin(), links.end());
  std::vector<ClothLink> ordered;
  std::vector<int> lane;
  while (!open.empty()) {
    std::set<int> used;
    int filled = 0, seen = 0;
    for (auto it = open.begin(); it != open.end() && filled < 4 && seen < kLookAhead; ++seen) {
      if (used.count(it->a) || used.count(it->b)) {
        ++it;
        continue;
      }
      used.insert({it->a, it->b});
      ordered.push_back(*it);
      lane.push_back(static_cast<int>(lane_count_) + filled++);
      it = open.erase(it);
    }
    lane_count_ += 4;
  }
  // Solved in an order that keeps the results of this one and does not wait as often.
  std::vector<std::array<int, 2>> nodes;
  for (const ClothLink& link : ordered) nodes.push_back({link.a, link.b});
  for (const std::array<int, 4>& four : PackFours(nodes, inv_mass.size())) {
    alignas(16) float rest[4] = {}, wa[4] = {}, wb[4] = {};
    Packet packet{};
    std::set<int> used;
    int filled = 0;
    for (const int i : four) {
      if (i < 0) continue;
      const ClothLink& link = ordered[i];
      used.insert({link.a, link.b});
      packet.a[filled] = static_cast<std::uint16_t>(link.a);
      packet.b[filled] = static_cast<std::uint16_t>(link.b);
      packet.lane[filled] = lane[i];
      rest[filled] = link.rest_m;
      wa[filled] = inv_mass[link.a];
      wb[filled] = inv_mass[link.b];
      ++filled;
    }
    // An empty lane writes back what it reads, so its nodes must be nobody
    // else's in the packet.
    for (int spare = 0, k = filled; k < 4; ++spare) {
      if (spare == static_cast<int>(inv_mass.size())) {
        throw std::invalid_argument("LinkSolver: too few nodes to fill the lanes of a packet");
      }
      if (used.count(spare)) continue;
      packet.a[k] = packet.b[k] = static_cast<std::uint16_t>(spare);
      packet.lane[k] = packet.lane[0];
      ++k;
    }
    packet.rest = Float4::Load(rest);
    packet.inv_mass_a = Float4::Load(wa);
    packet.inv_mass_b = Float4::Load(wb);
    packets_.push_back(packet);
  }
}

// What a sweep needs of its compliances, computed once.
struct LinkSolver::Compliances {
  explicit Compliances(const Sweep& sweep)
      : tension(sweep.tension),
        compression(sweep.compression),
        friction(sweep.friction.stiffness),
        slip_m(sweep.friction.slip_m),
        stiff_tension(Float4(1.0f) / tension),
        stiff_compression(Float4(1.0f) / compression),
        both_tension(stiff_tension + friction),
        both_compression(stiff_compression + friction),
        soft_tension(Float4(1.0f) / both_tension),
        soft_compression(Float4(1.0f) / both_compression),
        push(sweep.push),
        rubs(sweep.push && sweep.friction.stiffness > 0),
        both_ways(sweep.friction.both_ways) {}
  Float4 tension, compression, friction, slip_m;
  Float4 stiff_tension, stiff_compression;  // elastic part alone
  Float4 both_tension, both_compression;    // with friction's spring beside it
  Float4 soft_tension, soft_compression;    // compliance of both
  bool push, rubs, both_ways;
};

void LinkSolver::Solve(const Packet& p, const Compliances& with, float* set, Vec4Array& x) const {
  Float4 d[4], at_a[4], at_b[4];
  for (int k = 0; k < 4; ++k) {
    at_a[k] = Float4::Load(x[p.a[k]].data());
    at_b[k] = Float4::Load(x[p.b[k]].data());
    d[k] = at_b[k] - at_a[k];
  }
  Vec3x4 along = {d[0], d[1], d[2]};
  Float4 fourth = d[3];
  Transpose(along.x, along.y, along.z, fourth);
  const Float4 length = Sqrt(Dot(along, along));
  Float4 c = length - p.rest;
  const Float4 shorter = c < Float4(0.0f);
  Float4 active = Float4(1e-9f) < length;
  if (!with.push) active = active & (Float4(0.0f) < c);
  if (Bits(active) == 0) return;
  Float4 compliance = Select(shorter, with.compression, with.tension);
  if (with.rubs) {
    const Float4 was(set[p.lane[0]], set[p.lane[1]], set[p.lane[2]], set[p.lane[3]]);
    const Float4 held = Min(Max(was, c - with.slip_m), c + with.slip_m);
    alignas(16) float is[4];
    held.Store(is);
    // Backwards, for an empty lane stands for the first.
    for (int k = 4; k-- > 0;) set[p.lane[k]] = is[k];
    // Rest and compliance of the one spring that equals both.
    const Float4 elastic = Select(shorter, with.stiff_compression, with.stiff_tension);
    const Float4 both = Select(shorter, with.both_compression, with.both_tension);
    const Float4 soft = Select(shorter, with.soft_compression, with.soft_tension);
    const Float4 rubs = with.both_ways ? active : shorter;
    c = Select(rubs, (c * elastic + (c - held) * with.friction) / both, c);
    compliance = Select(rubs, soft, compliance);
  }
  const Float4 lambda = (c / ((p.inv_mass_a + p.inv_mass_b + compliance) * length)) & active;
  const Float4 share_a = lambda * p.inv_mass_a, share_b = lambda * p.inv_mass_b;
  const auto move = [&]<int k>(std::integral_constant<int, k>) {
    (at_a[k] + d[k] * Lane<k>(share_a)).Store(x[p.a[k]].data());
    (at_b[k] - d[k] * Lane<k>(share_b)).Store(x[p.b[k]].data());
  };
  move(std::integral_constant<int, 0>());
  move(std::integral_constant<int, 1>());
  move(std::integral_constant<int, 2>());
  move(std::integral_constant<int, 3>());
}

void LinkSolver::Solve(const Sweep& sweep, std::vector<float>& set, Vec4Array& x) const {
  const Compliances with(sweep);
  if (sweep.forward) {
    for (std::size_t i = 0; i < packets_.size(); ++i) Solve(packets_[i], with, set.data(), x);
  } else {
    for (std::size_t i = packets_.size(); i-- > 0;) Solve(packets_[i], with, set.data(), x);
  }
}

}  // namespace gusset
