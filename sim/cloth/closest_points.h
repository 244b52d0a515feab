#pragma once

#include "sim/cloth/simd.h"

namespace gusset {

/// Barycentric coordinates of a triangle's points, four triangles at once.
struct Barycentric4 {
  Float4 a, b, c;
};

/// Barycentric coordinates of the points of triangles abc that are closest to
/// p.
///
/// Inside: the projection onto the plane (Ericson, Real-Time Collision
/// Detection, 2005, section 3.4). Outside: the nearest of the three sides'
/// clamped projections (section 5.1.2). Coordinates that vanish are exactly
/// zero. A triangle without area falls back on its sides.
inline Barycentric4 ClosestOnTriangle(const Vec3x4& p, const Vec3x4& a, const Vec3x4& b,
                                      const Vec3x4& c) {
  const Float4 tiny = 1e-20f;
  const Vec3x4 ab = b - a, ac = c - a, bc = c - b, ap = p - a, bp = p - b;
  const Float4 d1 = Dot(ab, ap), d2 = Dot(ac, ap), d3 = Dot(bc, bp);
  const Float4 aa = Dot(ab, ab), cc = Dot(ac, ac), m = Dot(ab, ac), ee = Dot(bc, bc);
  const Float4 det = aa * cc - m * m;
  const Float4 v = cc * d1 - m * d2, w = aa * d2 - m * d1;
  const Float4 inside =
      (Float4(0.0f) < v) & (Float4(0.0f) < w) & (v + w < det) & (aa * cc * 1e-6f < det);
  const Float4 inv = Float4(1.0f) / Max(det, tiny);

  const Float4 t_ab = Clamp01(d1 / Max(aa, tiny));
  const Float4 t_ac = Clamp01(d2 / Max(cc, tiny));
  const Float4 t_bc = Clamp01(d3 / Max(ee, tiny));
  const Vec3x4 g_ab = ap - ab * t_ab, g_ac = ap - ac * t_ac, g_bc = bp - bc * t_bc;
  const Float4 q_ab = Dot(g_ab, g_ab), q_ac = Dot(g_ac, g_ac), q_bc = Dot(g_bc, g_bc);
  const Float4 take_ac = q_ac < q_ab;
  const Float4 take_bc = q_bc < Min(q_ab, q_ac);
  Float4 wb = Select(take_ac, 0.0f, t_ab), wc = Select(take_ac, t_ac, 0.0f);
  Float4 wa = Float4(1.0f) - wb - wc;
  wa = Select(take_bc, 0.0f, wa);
  wb = Select(take_bc, Float4(1.0f) - t_bc, wb);
  wc = Select(take_bc, t_bc, wc);
  const Float4 in_b = v * inv, in_c = w * inv;
  return {Select(inside, Float4(1.0f) - in_b - in_c, wa), Select(inside, in_b, wb),
          Select(inside, in_c, wc)};
}

/// Parameters s, t in [0, 1] of the closest points a + s (b - a) and c + t (d -
/// c) of segments. Ericson (2005), section 5.1.9; nearly parallel segments take
/// the middle of their overlap.
struct SegmentPoints4 {
  Float4 s, t;
};

inline SegmentPoints4 ClosestOnSegments(const Vec3x4& a, const Vec3x4& b, const Vec3x4& c,
                                        const Vec3x4& d) {
  const Float4 tiny = 1e-20f;
  const Vec3x4 u = b - a, v = d - c, r = a - c;
  const Float4 uu = Max(Dot(u, u), tiny), vv = Max(Dot(v, v), tiny);
  const Float4 ur = Dot(u, r), vr = Dot(v, r), uv = Dot(u, v);
  const Float4 det = uu * vv - uv * uv;
  const Float4 parallel = det <= uu * vv * 1e-4f;
  const Float4 s0 = Float4(0.0f) - ur / uu, s1 = s0 + uv / uu;
  const Float4 middle = (Clamp01(Min(s0, s1)) + Clamp01(Max(s0, s1))) * 0.5f;
  const Float4 crossing = Clamp01((uv * vr - ur * vv) / Max(det, tiny));
  const Float4 s = Select(parallel, middle, crossing);
  const Float4 t = (uv * s + vr) / vv;
  const Float4 clamped = Clamp01(t);
  const Float4 s_end = Clamp01((uv * clamped - ur) / uu);
  return {Select(t == clamped, s, s_end), clamped};
}

}  // namespace gusset
