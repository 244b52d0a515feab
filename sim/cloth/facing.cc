#include "sim/cloth/facing.h"

#include <algorithm>
#include <cassert>
#include <map>

#include "sim/cloth/simd8.h"

namespace gusset {
namespace {

// Sine of an angle: a border is left to its neighbour when the cloth goes on towards the node by
// more than this. Tuned 2026-11: flat cloth is rounded to less than a hundredth (LayerFriction).
constexpr float kLean = 0.01f;
// Nodes half an edge to the side of a ridge keep a thickness less half an edge times the sine
// there. An edge keeps a whole one from this share of the sine at which that is nothing; tuned
// 2026-11 (RestAfterADrop), where three and five times as much rests too, but a threshold does not.
constexpr float kRidgeShare = 2.0f / 3.0f;
// And nothing up to this share of that sine.
constexpr float kFlatShare = 0.2f;

float MeanEdge(const ClothMesh& mesh) {
  float sum = 0;
  for (const ClothLink& yarn : mesh.stretch) sum += yarn.rest_m;
  return sum / static_cast<float>(mesh.stretch.size());
}

// Unit vector from the line through a and b to c, across that line; zero where c lies on it.
Vec4f Across(const Vec4f& a, const Vec4f& b, const Vec4f& c) {
  const Vec4f side = b - a, to = c - a;
  const Vec4f off = to - side * (to.dot(side) / std::max(side.squaredNorm(), 1e-20f));
  return off / std::max(off.norm(), 1e-12f);
}

}  // namespace

Facing::Facing(const ClothMesh& mesh)
    : mesh_(mesh),
      ridge_sine_(kRidgeShare * mesh.thickness_m / (0.5f * MeanEdge(mesh))),
      around_(mesh.rest.size()) {
  std::vector<char> corner_owned(mesh.rest.size(), 0);
  std::map<std::array<int, 2>, std::array<int, 2>> across;
  const auto key = [](int a, int b) { return std::array<int, 2>{std::min(a, b), std::max(a, b)}; };
  for (const auto& t : mesh.triangles) {
    int owned = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = t[k], b = t[(k + 1) % 3], c = t[(k + 2) % 3];
      if (!corner_owned[a]) owned |= 1 << k;
      corner_owned[a] = 1;
      const auto [at, first] = across.insert({key(a, b), {c, -1}});
      if (first) owned |= 8 << k;
      assert(first || at->second[1] < 0);  // no edge has three triangles
      if (!first) at->second[1] = c;
    }
    owned_.push_back(static_cast<std::uint8_t>(owned));
  }
  for (const auto& e : mesh.edges) {
    across_edge_.push_back(across.at(key(e[0], e[1])));
    around_[e[0]].push_back(e[1]);
    around_[e[1]].push_back(e[0]);
  }
  for (const auto& t : mesh.triangles) {
    std::array<int, 3> beyond;
    for (int k = 0; k < 3; ++k) {
      const auto& both = across.at(key(t[k], t[(k + 1) % 3]));
      beyond[k] = both[0] == t[(k + 2) % 3] ? both[1] : both[0];
    }
    across_side_.push_back(beyond);
  }
}

bool Facing::Owns(int triangle, const std::array<float, 3>& b) const {
  const int zeros = (b[0] <= 0) + (b[1] <= 0) + (b[2] <= 0);
  for (int k = 0; k < 3; ++k) {
    if (zeros == 2 && b[k] > 0) return owned_[triangle] >> k & 1;
    if (zeros == 1 && b[(k + 2) % 3] <= 0) return owned_[triangle] >> (3 + k) & 1;
  }
  return true;
}

bool Facing::IsClosest(int triangle, const std::array<float, 3>& b, const Vec4f& outwards,
                       const Vec4Array& x) const {
  const auto& t = mesh_.triangles[triangle];
  const int zeros = (b[0] <= 0) + (b[1] <= 0) + (b[2] <= 0);
  for (int k = 0; k < 3; ++k) {
    if (zeros == 2 && b[k] > 0) {
      return std::none_of(around_[t[k]].begin(), around_[t[k]].end(), [&](int other) {
        const Vec4f along = x[other] - x[t[k]];
        return outwards.dot(along) > kLean * along.norm();
      });
    }
    if (zeros == 1 && b[(k + 2) % 3] <= 0) {
      const Vec4f &from = x[t[k]], &to = x[t[(k + 1) % 3]];
      const int beyond = across_side_[triangle][k];
      return outwards.dot(Across(from, to, x[t[(k + 2) % 3]])) <= kLean &&
             (beyond < 0 || outwards.dot(Across(from, to, x[beyond])) <= kLean);
    }
  }
  return true;
}

void Facing::FindRidgeShares(const Vec4Array& x, EdgeQuery& query) const {
  // Sums in the order of Eigen's, which IsClosest uses.
  const auto dot = [](const Vec3x8& a, const Vec3x8& b) {
    return a.x * b.x + a.z * b.z + a.y * b.y;
  };
  std::array<int, kLanes8> from, to, first, second;
  for (std::size_t k = 0; k < kLanes8; ++k) {
    const std::uint16_t edge = query.edge[k];
    from[k] = mesh_.edges[edge][0], to[k] = mesh_.edges[edge][1];
    first[k] = across_edge_[edge][0];
    second[k] = across_edge_[edge][1] < 0 ? first[k] : across_edge_[edge][1];
  }
  const Vec3x8 outwards = {Float8::Load(query.outwards_x.data()),
                           Float8::Load(query.outwards_y.data()),
                           Float8::Load(query.outwards_z.data())};
  const Vec3x8 start = Gather(x.data(), from), side = Gather(x.data(), to) - start;
  const Float8 length2 = Max(dot(side, side), 1e-20f);
  // As Across.
  const auto sine = [&](const std::array<int, kLanes8>& beyond) {
    const Vec3x8 to = Gather(x.data(), beyond) - start;
    const Vec3x8 off = to - side * (dot(to, side) / length2);
    const Float8 length = Max(Sqrt(dot(off, off)), 1e-12f);
    return dot(outwards, {off.x / length, off.y / length, off.z / length});
  };
  const Float8 inside = Float8(0.0f) - Max(sine(first), sine(second));
  Clamp01((inside / ridge_sine_ - kFlatShare) / (1 - kFlatShare)).Store(query.share.data());
}

void Facing::FindRidges(const Vec4Array& x, std::vector<std::uint8_t>& ridge) const {
  // Across, four edges at a time.
  const auto across = [](const Vec3x4& from, const Vec3x4& side, Float4 length2, const Vec3x4& p) {
    const Vec3x4 to = p - from;
    const Vec3x4 off = to - side * (Dot(to, side) / length2);
    return off * (Float4(1.0f) / Max(Sqrt(Dot(off, off)), 1e-12f));
  };
  // A direction halfway between the two sides is half their sum inside the cone.
  const float flat = 2 * kFlatShare * ridge_sine_;
  const std::size_t count = mesh_.edges.size();
  ridge.resize(count);
  for (std::size_t i = 0; i < count; i += 4) {
    const auto last = [&](std::size_t k) { return std::min(i + k, count - 1); };
    const auto at = [&](const auto& node) {
      return Gather(x.data(), node(last(0)), node(last(1)), node(last(2)), node(last(3)));
    };
    const Vec3x4 from = at([&](std::size_t e) { return mesh_.edges[e][0]; });
    const Vec3x4 side = at([&](std::size_t e) { return mesh_.edges[e][1]; }) - from;
    const Float4 length2 = Max(Dot(side, side), 1e-20f);
    const Vec3x4 first =
        across(from, side, length2, at([&](std::size_t e) { return across_edge_[e][0]; }));
    const Vec3x4 second = across(
        from, side, length2, at([&](std::size_t e) { return std::max(across_edge_[e][1], 0); }));
    const Vec3x4 sum = first + second;
    const int bent = Bits(Float4(flat * flat) < Dot(sum, sum));
    for (std::size_t k = 0; k < 4 && i + k < count; ++k) {
      ridge[i + k] = (bent >> k & 1) | (across_edge_[i + k][1] < 0);
    }
  }
}

}  // namespace gusset
