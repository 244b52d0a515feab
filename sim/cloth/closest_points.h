#pragma once

#include <algorithm>

#include "sim/cloth/cloth_types.h"

namespace gusset {

/// Barycentric coordinates of the point of triangle abc that is closest to p.
/// Ericson, Real-Time Collision Detection (2005), section 5.1.5.
inline Vec3f ClosestOnTriangle(const Vec3f& p, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f ab = b - a, ac = c - a, ap = p - a;
  const float d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const Vec3f bp = p - b;
  const float d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const float t = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
    return {1 - t, t, 0};
  }
  const Vec3f cp = p - c;
  const float d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const float t = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
    return {1 - t, 0, t};
  }
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const float sum = (d4 - d3) + (d5 - d6);
    const float t = sum > 0 ? (d4 - d3) / sum : 0;
    return {0, 1 - t, t};
  }
  const float inv = 1.0f / (va + vb + vc);
  return {va * inv, vb * inv, vc * inv};
}

/// Parameters (s, t) in [0, 1] of the closest points a + s (b - a) and c + t (d - c) of two segments.
/// Ericson (2005), section 5.1.9; nearly parallel segments take the middle of their overlap.
inline Eigen::Vector2f ClosestOnSegments(const Vec3f& a, const Vec3f& b, const Vec3f& c,
                                         const Vec3f& d) {
  const Vec3f u = b - a, v = d - c, r = a - c;
  const float uu = u.squaredNorm(), vv = v.squaredNorm();
  const float ur = u.dot(r), vr = v.dot(r), uv = u.dot(v);
  const float det = uu * vv - uv * uv;
  float s;
  if (det > 1e-4f * uu * vv) {
    s = std::clamp((uv * vr - ur * vv) / det, 0.0f, 1.0f);
  } else if (uu > 0) {
    // Project c and d onto ab and take the middle of the common part.
    const float s0 = -ur / uu, s1 = s0 + uv / uu;
    const float lo = std::clamp(std::min(s0, s1), 0.0f, 1.0f);
    const float hi = std::clamp(std::max(s0, s1), 0.0f, 1.0f);
    s = 0.5f * (lo + hi);
  } else {
    s = 0;
  }
  float t = vv > 0 ? (uv * s + vr) / vv : 0;
  if (t < 0 || t > 1) {
    t = std::clamp(t, 0.0f, 1.0f);
    s = uu > 0 ? std::clamp((uv * t - ur) / uu, 0.0f, 1.0f) : 0;
  }
  return {s, t};
}

}  // namespace gusset
