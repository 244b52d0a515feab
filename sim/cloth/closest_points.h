#pragma once

#include "sim/cloth/simd.h"

namespace gusset {

/// Barycentric coordinates of triangles' points, one triangle per lane.
template <class F>
struct Barycentric {
  F a, b, c;
};

/// Barycentric coordinates of the points of triangles abc that are closest to
/// p.
///
/// Inside: the projection onto the plane (Ericson, Real-Time Collision
/// Detection, 2005, section 3.4). Outside: the nearest of the three sides'
/// clamped projections (section 5.1.2). Coordinates that vanish are exactly
/// zero. A triangle without area falls back on its sides.
template <class F>
[[gnu::always_inline]] inline Barycentric<F> ClosestOnTriangle(const Vec3Lanes<F>& p,
                                                               const Vec3Lanes<F>& a,
                                                               const Vec3Lanes<F>& b,
                                                               const Vec3Lanes<F>& c) {
  const F tiny = 1e-20f;
  const Vec3Lanes<F> ab = b - a, ac = c - a, bc = c - b, ap = p - a, bp = p - b;
  const F d1 = Dot(ab, ap), d2 = Dot(ac, ap), d3 = Dot(bc, bp);
  const F aa = Dot(ab, ab), cc = Dot(ac, ac), m = Dot(ab, ac), ee = Dot(bc, bc);
  const F det = aa * cc - m * m;
  const F v = cc * d1 - m * d2, w = aa * d2 - m * d1;
  const F inside = (F(0.0f) < v) & (F(0.0f) < w) & (v + w < det) & (aa * cc * 1e-6f < det);
  const F inv = F(1.0f) / Max(det, tiny);

  const F t_ab = Clamp01(d1 / Max(aa, tiny));
  const F t_ac = Clamp01(d2 / Max(cc, tiny));
  const F t_bc = Clamp01(d3 / Max(ee, tiny));
  const Vec3Lanes<F> g_ab = ap - ab * t_ab, g_ac = ap - ac * t_ac, g_bc = bp - bc * t_bc;
  const F q_ab = Dot(g_ab, g_ab), q_ac = Dot(g_ac, g_ac), q_bc = Dot(g_bc, g_bc);
  const F take_ac = q_ac < q_ab;
  const F take_bc = q_bc < Min(q_ab, q_ac);
  F wb = Select(take_ac, 0.0f, t_ab), wc = Select(take_ac, t_ac, 0.0f);
  F wa = F(1.0f) - wb - wc;
  wa = Select(take_bc, 0.0f, wa);
  wb = Select(take_bc, F(1.0f) - t_bc, wb);
  wc = Select(take_bc, t_bc, wc);
  const F in_b = v * inv, in_c = w * inv;
  return {Select(inside, F(1.0f) - in_b - in_c, wa), Select(inside, in_b, wb),
          Select(inside, in_c, wc)};
}

/// Parameters s, t in [0, 1] of the closest points a + s (b - a) and c + t (d -
/// c) of segments. Ericson (2005), section 5.1.9; nearly parallel segments take
/// the middle of their overlap.
template <class F>
struct SegmentPoints {
  F s, t;
};

template <class F>
[[gnu::always_inline]] inline SegmentPoints<F> ClosestOnSegments(const Vec3Lanes<F>& a,
                                                                 const Vec3Lanes<F>& b,
                                                                 const Vec3Lanes<F>& c,
                                                                 const Vec3Lanes<F>& d) {
  const F tiny = 1e-20f;
  const Vec3Lanes<F> u = b - a, v = d - c, r = a - c;
  const F uu = Max(Dot(u, u), tiny), vv = Max(Dot(v, v), tiny);
  const F ur = Dot(u, r), vr = Dot(v, r), uv = Dot(u, v);
  const F det = uu * vv - uv * uv;
  const F parallel = det <= uu * vv * 1e-4f;
  const F s0 = F(0.0f) - ur / uu, s1 = s0 + uv / uu;
  const F middle = (Clamp01(Min(s0, s1)) + Clamp01(Max(s0, s1))) * 0.5f;
  const F crossing = Clamp01((uv * vr - ur * vv) / Max(det, tiny));
  const F s = Select(parallel, middle, crossing);
  const F t = (uv * s + vr) / vv;
  const F clamped = Clamp01(t);
  const F s_end = Clamp01((uv * clamped - ur) / uu);
  return {Select(t == clamped, s, s_end), clamped};
}

}  // namespace gusset
