#pragma once

#include <array>

#include "sim/cloth/simd.h"

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace gusset {

// Two types, for files built with AVX2 and files built without must not share an inline function of
// another layout.
#ifdef __AVX2__
inline namespace avx2 {
#else
inline namespace sse {
#endif

/// Eight floats, or eight truth values: one register where the build has AVX2, two where it has
/// not. Nothing is fused, so a lane's bits are the same either way, and Float4's.
struct Float8 {
#ifdef __AVX2__
  __m256 v;
  Float8() : v(_mm256_setzero_ps()) {}
  Float8(__m256 lanes) : v(lanes) {}
  Float8(float all) : v(_mm256_set1_ps(all)) {}
  Float8(Float4 low, Float4 high) : v(_mm256_set_m128(high.v, low.v)) {}
  static Float8 Load(const float* aligned) { return _mm256_load_ps(aligned); }
  void Store(float* aligned) const { _mm256_store_ps(aligned, v); }
  Float4 low() const { return _mm256_castps256_ps128(v); }
  Float4 high() const { return _mm256_extractf128_ps(v, 1); }
#else
  Float4 lo, hi;
  Float8() = default;
  Float8(float all) : lo(all), hi(all) {}
  Float8(Float4 low, Float4 high) : lo(low), hi(high) {}
  static Float8 Load(const float* aligned) {
    return {Float4::Load(aligned), Float4::Load(aligned + 4)};
  }
  void Store(float* aligned) const { lo.Store(aligned), hi.Store(aligned + 4); }
  Float4 low() const { return lo; }
  Float4 high() const { return hi; }
#endif
};

#ifdef __AVX2__
inline Float8 operator+(Float8 a, Float8 b) { return _mm256_add_ps(a.v, b.v); }
inline Float8 operator-(Float8 a, Float8 b) { return _mm256_sub_ps(a.v, b.v); }
inline Float8 operator*(Float8 a, Float8 b) { return _mm256_mul_ps(a.v, b.v); }
inline Float8 operator/(Float8 a, Float8 b) { return _mm256_div_ps(a.v, b.v); }
inline Float8 operator<(Float8 a, Float8 b) { return _mm256_cmp_ps(a.v, b.v, _CMP_LT_OS); }
inline Float8 operator<=(Float8 a, Float8 b) { return _mm256_cmp_ps(a.v, b.v, _CMP_LE_OS); }
inline Float8 operator==(Float8 a, Float8 b) { return _mm256_cmp_ps(a.v, b.v, _CMP_EQ_OQ); }
inline Float8 operator&(Float8 a, Float8 b) { return _mm256_and_ps(a.v, b.v); }
inline Float8 Min(Float8 a, Float8 b) { return _mm256_min_ps(a.v, b.v); }
inline Float8 Max(Float8 a, Float8 b) { return _mm256_max_ps(a.v, b.v); }
inline Float8 Sqrt(Float8 a) { return _mm256_sqrt_ps(a.v); }
inline Float8 Abs(Float8 a) { return _mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v); }
inline Float8 Negated(Float8 a) { return _mm256_xor_ps(_mm256_set1_ps(-0.0f), a.v); }
/// Per lane: mask ? a : b.
inline Float8 Select(Float8 mask, Float8 a, Float8 b) { return _mm256_blendv_ps(b.v, a.v, mask.v); }
/// Bit k: lane k of a mask.
inline int Bits(Float8 mask) { return _mm256_movemask_ps(mask.v); }
/// High half first.
inline Float8 HalvesSwapped(Float8 a) { return _mm256_permute2f128_ps(a.v, a.v, 1); }
/// Rows of the 4x4 matrices in the low and in the high halves become their columns.
inline void TransposeHalves(Float8& a, Float8& b, Float8& c, Float8& d) {
  const __m256 ab02 = _mm256_unpacklo_ps(a.v, b.v), ab13 = _mm256_unpackhi_ps(a.v, b.v);
  const __m256 cd02 = _mm256_unpacklo_ps(c.v, d.v), cd13 = _mm256_unpackhi_ps(c.v, d.v);
  a.v = _mm256_shuffle_ps(ab02, cd02, 0x44), b.v = _mm256_shuffle_ps(ab02, cd02, 0xee);
  c.v = _mm256_shuffle_ps(ab13, cd13, 0x44), d.v = _mm256_shuffle_ps(ab13, cd13, 0xee);
}
#else
inline Float8 operator+(Float8 a, Float8 b) { return {a.lo + b.lo, a.hi + b.hi}; }
inline Float8 operator-(Float8 a, Float8 b) { return {a.lo - b.lo, a.hi - b.hi}; }
inline Float8 operator*(Float8 a, Float8 b) { return {a.lo * b.lo, a.hi * b.hi}; }
inline Float8 operator/(Float8 a, Float8 b) { return {a.lo / b.lo, a.hi / b.hi}; }
inline Float8 operator<(Float8 a, Float8 b) { return {a.lo < b.lo, a.hi < b.hi}; }
inline Float8 operator<=(Float8 a, Float8 b) { return {a.lo <= b.lo, a.hi <= b.hi}; }
inline Float8 operator==(Float8 a, Float8 b) { return {a.lo == b.lo, a.hi == b.hi}; }
inline Float8 operator&(Float8 a, Float8 b) { return {a.lo & b.lo, a.hi & b.hi}; }
inline Float8 Min(Float8 a, Float8 b) { return {Min(a.lo, b.lo), Min(a.hi, b.hi)}; }
inline Float8 Max(Float8 a, Float8 b) { return {Max(a.lo, b.lo), Max(a.hi, b.hi)}; }
inline Float8 Sqrt(Float8 a) { return {Sqrt(a.lo), Sqrt(a.hi)}; }
inline Float8 Abs(Float8 a) { return {Abs(a.lo), Abs(a.hi)}; }
inline Float8 Negated(Float8 a) {
  const __m128 sign = _mm_set1_ps(-0.0f);
  return {_mm_xor_ps(sign, a.lo.v), _mm_xor_ps(sign, a.hi.v)};
}
inline Float8 Select(Float8 mask, Float8 a, Float8 b) {
  return {Select(mask.lo, a.lo, b.lo), Select(mask.hi, a.hi, b.hi)};
}
inline int Bits(Float8 mask) { return Bits(mask.lo) | Bits(mask.hi) << 4; }
inline Float8 HalvesSwapped(Float8 a) { return {a.hi, a.lo}; }
inline void TransposeHalves(Float8& a, Float8& b, Float8& c, Float8& d) {
  Transpose(a.lo, b.lo, c.lo, d.lo);
  Transpose(a.hi, b.hi, c.hi, d.hi);
}
#endif
inline Float8 Clamp01(Float8 a) { return Min(Max(a, 0.0f), 1.0f); }

inline Float8 Of(const std::array<float, kLanes8>& aligned) { return Float8::Load(aligned.data()); }

using Vec3x8 = Vec3Lanes<Float8>;

/// Calls visit(lane, xyz0) for the first `count` lanes, each as a node's vector.
template <class Visit>
[[gnu::always_inline]] inline void ForEachLane(const Vec3x8& v, std::size_t count, Visit visit) {
  Float8 rows[4] = {v.x, v.y, v.z, Float8()};
  TransposeHalves(rows[0], rows[1], rows[2], rows[3]);
  for (std::size_t lane = 0; lane < count; ++lane) {
    const Float8& pair = rows[lane % 4];
    visit(lane, lane < 4 ? pair.low() : pair.high());
  }
}

/// The vectors at eight indices; `fourth` receives their fourth lanes.
template <class Index>
[[gnu::always_inline]] inline Vec3x8 Gather(const Vec4f* at, const std::array<Index, kLanes8>& i,
                                            Float8* fourth = nullptr) {
  const auto both = [&](int k) {
    return Float8(Float4::Load(at[i[k]].data()), Float4::Load(at[i[k + 4]].data()));
  };
  Float8 a = both(0), b = both(1), c = both(2), d = both(3);
  TransposeHalves(a, b, c, d);
  if (fourth) *fourth = d;
  return {a, b, c};
}

}  // inline namespace
}  // namespace gusset
