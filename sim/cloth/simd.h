#pragma once

#include <xmmintrin.h>

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace gusset {

/// A node's vector with an unused fourth lane (0 unless said otherwise): one
/// aligned load.
using Vec4f = Eigen::Vector4f;
using Vec4Array = std::vector<Vec4f>;

/// Lanes of Float8 (simd8.h), for what headers lay out for it.
constexpr std::size_t kLanes8 = 8;

/// Four floats, or four truth values, one per lane. SSE only, which every
/// x86-64 has, and no fused operations: a lane's bits are those of the same
/// scalar arithmetic.
struct Float4 {
  __m128 v;
  Float4() : v(_mm_setzero_ps()) {}
  Float4(__m128 lanes) : v(lanes) {}
  Float4(float all) : v(_mm_set1_ps(all)) {}
  Float4(float a, float b, float c, float d) : v(_mm_setr_ps(a, b, c, d)) {}
  static Float4 Load(const float* aligned) { return _mm_load_ps(aligned); }
  void Store(float* aligned) const { _mm_store_ps(aligned, v); }
};
inline Float4 Loadu(const float* p) { return _mm_loadu_ps(p); }
inline void Storeu(Float4 a, float* p) { _mm_storeu_ps(p, a.v); }

inline Float4 operator+(Float4 a, Float4 b) { return _mm_add_ps(a.v, b.v); }
inline Float4 operator-(Float4 a, Float4 b) { return _mm_sub_ps(a.v, b.v); }
inline Float4 operator*(Float4 a, Float4 b) { return _mm_mul_ps(a.v, b.v); }
inline Float4 operator/(Float4 a, Float4 b) { return _mm_div_ps(a.v, b.v); }
inline Float4 operator<(Float4 a, Float4 b) { return _mm_cmplt_ps(a.v, b.v); }
inline Float4 operator<=(Float4 a, Float4 b) { return _mm_cmple_ps(a.v, b.v); }
inline Float4 operator==(Float4 a, Float4 b) { return _mm_cmpeq_ps(a.v, b.v); }
inline Float4 operator&(Float4 a, Float4 b) { return _mm_and_ps(a.v, b.v); }
inline Float4 operator|(Float4 a, Float4 b) { return _mm_or_ps(a.v, b.v); }
inline Float4 Min(Float4 a, Float4 b) { return _mm_min_ps(a.v, b.v); }
inline Float4 Max(Float4 a, Float4 b) { return _mm_max_ps(a.v, b.v); }
inline Float4 Sqrt(Float4 a) { return _mm_sqrt_ps(a.v); }
inline Float4 Abs(Float4 a) { return _mm_andnot_ps(_mm_set1_ps(-0.0f), a.v); }
inline Float4 Clamp01(Float4 a) { return Min(Max(a, 0.0f), 1.0f); }
/// Per lane: mask ? a : b.
inline Float4 Select(Float4 mask, Float4 a, Float4 b) {
  return _mm_or_ps(_mm_and_ps(mask.v, a.v), _mm_andnot_ps(mask.v, b.v));
}
/// Bit k: lane k of a mask.
inline int Bits(Float4 mask) { return _mm_movemask_ps(mask.v); }

/// Lane k in all lanes.
template <int k>
Float4 Lane(Float4 a) {
  return _mm_shuffle_ps(a.v, a.v, k * 0x55);
}

/// Sum of the first three lanes.
inline float Sum3(Float4 a) {
  const __m128 second = _mm_shuffle_ps(a.v, a.v, 1);
  const __m128 third = _mm_movehl_ps(a.v, a.v);
  return _mm_cvtss_f32(_mm_add_ss(_mm_add_ss(a.v, second), third));
}

/// As many 3-vectors as F has lanes, component by component.
template <class F>
struct Vec3Lanes {
  F x, y, z;
};
using Vec3x4 = Vec3Lanes<Float4>;

template <class F>
Vec3Lanes<F> operator+(const Vec3Lanes<F>& a, const Vec3Lanes<F>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class F>
Vec3Lanes<F> operator-(const Vec3Lanes<F>& a, const Vec3Lanes<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class F>
Vec3Lanes<F> operator*(const Vec3Lanes<F>& a, std::type_identity_t<F> s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <class F>
F Dot(const Vec3Lanes<F>& a, const Vec3Lanes<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Rows of a 4x4 matrix become its columns.
inline void Transpose(Float4& a, Float4& b, Float4& c, Float4& d) {
  _MM_TRANSPOSE4_PS(a.v, b.v, c.v, d.v);
}

/// The vectors at four indices; `fourth` receives their fourth lanes.
inline Vec3x4 Gather(const Vec4f* at, int i0, int i1, int i2, int i3, Float4* fourth = nullptr) {
  Float4 a = Float4::Load(at[i0].data()), b = Float4::Load(at[i1].data());
  Float4 c = Float4::Load(at[i2].data()), d = Float4::Load(at[i3].data());
  Transpose(a, b, c, d);
  if (fourth) *fourth = d;
  return {a, b, c};
}

}  // namespace gusset
