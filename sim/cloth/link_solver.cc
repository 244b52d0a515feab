#include "sim/cloth/link_solver.h"

#include <algorithm>
#include <list>
#include <set>

namespace gusset {
namespace {

constexpr int kLookAhead = 64;  // links looked through for one that shares no node with its packet

}  // namespace

LinkSolver::LinkSolver(const std::vector<ClothLink>& links, const std::vector<float>& inv_mass) {
  std::list<ClothLink> open(links.begin(), links.end());
  while (!open.empty()) {
    alignas(16) float rest[4] = {}, wa[4] = {}, wb[4] = {};
    Packet packet{};
    std::set<int> used;
    int filled = 0, seen = 0;
    for (auto it = open.begin(); it != open.end() && filled < 4 && seen < kLookAhead; ++seen) {
      if (used.count(it->a) || used.count(it->b)) {
        ++it;
        continue;
      }
      used.insert({it->a, it->b});
      packet.a[filled] = static_cast<std::uint16_t>(it->a);
      packet.b[filled] = static_cast<std::uint16_t>(it->b);
      rest[filled] = it->rest_m;
      wa[filled] = inv_mass[it->a];
      wb[filled] = inv_mass[it->b];
      ++filled;
      it = open.erase(it);
    }
    // An empty lane writes back what it reads, so its nodes must be nobody
    // else's in the packet.
    for (int spare = 0; filled < 4; ++spare) {
      if (used.count(spare)) continue;
      packet.a[filled] = packet.b[filled] = static_cast<std::uint16_t>(spare);
      ++filled;
    }
    packet.rest = Float4::Load(rest);
    packet.inv_mass_a = Float4::Load(wa);
    packet.inv_mass_b = Float4::Load(wb);
    packets_.push_back(packet);
  }
}

void LinkSolver::Solve(const Packet& p, const Sweep& sweep, float* set, Vec4Array& x) const {
  const Vec3x4 d = Gather(x.data(), p.b[0], p.b[1], p.b[2], p.b[3]) -
                   Gather(x.data(), p.a[0], p.a[1], p.a[2], p.a[3]);
  const Float4 length = Sqrt(Dot(d, d));
  Float4 c = length - p.rest;
  const Float4 shorter = c < Float4(0.0f);
  Float4 active = Float4(1e-9f) < length;
  if (!sweep.push) active = active & (Float4(0.0f) < c);
  if (Bits(active) == 0) return;
  Float4 compliance = Select(shorter, sweep.compression, sweep.tension);
  if (const Friction& friction = sweep.friction; sweep.push && friction.stiffness > 0) {
    const Float4 slip = friction.slip_m;
    const Float4 held = Min(Max(Loadu(set), c - slip), c + slip);
    Storeu(held, set);
    // Rest and compliance of the one spring that equals both.
    const Float4 elastic = Float4(1.0f) / compliance;
    const Float4 both = elastic + Float4(friction.stiffness);
    const Float4 rubs = friction.both_ways ? active : shorter;
    c = Select(rubs, (c * elastic + (c - held) * Float4(friction.stiffness)) / both, c);
    compliance = Select(rubs, Float4(1.0f) / both, compliance);
  }
  const Float4 lambda = (c / ((p.inv_mass_a + p.inv_mass_b + compliance) * length)) & active;
  Vec3x4 move = d * (lambda * p.inv_mass_a);
  Float4 fourth;
  Transpose(move.x, move.y, move.z, fourth);
  const Float4 to_a[4] = {move.x, move.y, move.z, fourth};
  move = d * (lambda * p.inv_mass_b);
  fourth = Float4();
  Transpose(move.x, move.y, move.z, fourth);
  const Float4 to_b[4] = {move.x, move.y, move.z, fourth};
  for (int k = 0; k < 4; ++k) {
    float* a = x[p.a[k]].data();
    (Float4::Load(a) + to_a[k]).Store(a);
    float* b = x[p.b[k]].data();
    (Float4::Load(b) - to_b[k]).Store(b);
  }
}

void LinkSolver::Solve(const Sweep& sweep, std::vector<float>& set, Vec4Array& x) const {
  if (sweep.forward) {
    for (std::size_t i = 0; i < packets_.size(); ++i) Solve(packets_[i], sweep, &set[4 * i], x);
  } else {
    for (std::size_t i = packets_.size(); i-- > 0;) Solve(packets_[i], sweep, &set[4 * i], x);
  }
}

}  // namespace gusset
