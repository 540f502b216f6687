#pragma once
// Eight numbers at a time: AVX2 where the file is compiled for it, plain loops elsewhere. Every operation rounds as one
// IEEE operation per lane and none is fused, so both give the same bits.
//
// Everything here is in an unnamed namespace: two files with different instruction sets include it, and the linker must
// not take a function of one for the other.
#include <cstdint>
#if defined(__AVX2__)
#include <immintrin.h>
#endif

namespace sightcell::bake::cpu {
namespace {

#if defined(__AVX2__)

struct floats {
  __m256 v;
};
struct ints {
  __m256i v;
};

inline floats load(const float* p) {
  return {_mm256_load_ps(p)};
}
inline ints load(const std::int32_t* p) {
  return {_mm256_load_si256(reinterpret_cast<const __m256i*>(p))};
}
inline ints load(const std::uint32_t* p) {
  return {_mm256_load_si256(reinterpret_cast<const __m256i*>(p))};
}
inline void store(float* p, floats a) {
  _mm256_store_ps(p, a.v);
}
inline void store(std::int32_t* p, ints a) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(p), a.v);
}
inline void store(std::uint32_t* p, ints a) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(p), a.v);
}
inline floats all(float a) {
  return {_mm256_set1_ps(a)};
}
inline ints all(std::int32_t a) {
  return {_mm256_set1_epi32(a)};
}
inline ints count_up() {  // 0, 1 ... 7
  return {_mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7)};
}
inline floats operator+(floats a, floats b) {
  return {_mm256_add_ps(a.v, b.v)};
}
inline floats operator-(floats a, floats b) {
  return {_mm256_sub_ps(a.v, b.v)};
}
inline floats operator*(floats a, floats b) {
  return {_mm256_mul_ps(a.v, b.v)};
}
inline floats operator/(floats a, floats b) {
  return {_mm256_div_ps(a.v, b.v)};
}
inline floats smaller(floats a, floats b) {
  return {_mm256_min_ps(a.v, b.v)};
}
inline floats larger(floats a, floats b) {
  return {_mm256_max_ps(a.v, b.v)};
}
inline floats magnitude(floats a) {
  return {_mm256_andnot_ps(_mm256_set1_ps(-0.0f), a.v)};
}
// Masks: all bits of a lane set or none.
inline ints operator>(floats a, floats b) {
  return {_mm256_castps_si256(_mm256_cmp_ps(a.v, b.v, _CMP_GT_OQ))};
}
inline ints operator>=(floats a, floats b) {
  return {_mm256_castps_si256(_mm256_cmp_ps(a.v, b.v, _CMP_GE_OQ))};
}
inline ints operator+(ints a, ints b) {
  return {_mm256_add_epi32(a.v, b.v)};
}
inline ints operator-(ints a, ints b) {
  return {_mm256_sub_epi32(a.v, b.v)};
}
inline ints operator*(ints a, ints b) {
  return {_mm256_mullo_epi32(a.v, b.v)};
}
inline ints operator|(ints a, ints b) {
  return {_mm256_or_si256(a.v, b.v)};
}
inline ints operator&(ints a, ints b) {
  return {_mm256_and_si256(a.v, b.v)};
}
inline ints without(ints a, ints b) {  // a & ~b
  return {_mm256_andnot_si256(b.v, a.v)};
}
inline ints smaller(ints a, ints b) {
  return {_mm256_min_epi32(a.v, b.v)};
}
inline ints larger(ints a, ints b) {
  return {_mm256_max_epi32(a.v, b.v)};
}
inline ints operator>(ints a, ints b) {
  return {_mm256_cmpgt_epi32(a.v, b.v)};
}
inline ints operator==(ints a, ints b) {
  return {_mm256_cmpeq_epi32(a.v, b.v)};
}
template <int bits>
inline ints shift_right(ints a) {  // keeps the sign
  return {_mm256_srai_epi32(a.v, bits)};
}
inline ints rounded(floats a) {  // to nearest, halves to even
  return {_mm256_cvtps_epi32(a.v)};
}
inline ints truncated(floats a) {  // towards zero
  return {_mm256_cvttps_epi32(a.v)};
}
inline floats to_floats(ints a) {
  return {_mm256_cvtepi32_ps(a.v)};
}
inline floats choose(ints mask, floats yes, floats no) {  // by the sign bit of the mask
  return {_mm256_blendv_ps(no.v, yes.v, _mm256_castsi256_ps(mask.v))};
}
inline ints choose(ints mask, ints yes, ints no) {
  return {_mm256_castps_si256(
      _mm256_blendv_ps(_mm256_castsi256_ps(no.v), _mm256_castsi256_ps(yes.v), _mm256_castsi256_ps(mask.v)))};
}
inline std::uint32_t sign_bits(ints a) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_castsi256_ps(a.v)));
}
inline std::uint32_t sign_bits(floats a) {
  return static_cast<std::uint32_t>(_mm256_movemask_ps(a.v));
}
inline floats floor_of(floats a) {
  return {_mm256_floor_ps(a.v)};
}
// The bytes at base + offset; three bytes after each are read too.
inline ints bytes_at(const std::uint8_t* base, ints offset) {
  return {_mm256_and_si256(_mm256_i32gather_epi32(reinterpret_cast<const int*>(base), offset.v, 1),
                           _mm256_set1_epi32(0xFF))};
}
// Lane k becomes lane (k + 1) % 8: what a lane's left neighbor was.
inline floats rotated(floats a) {
  return {_mm256_permutevar8x32_ps(a.v, _mm256_setr_epi32(7, 0, 1, 2, 3, 4, 5, 6))};
}
inline floats first_lane_from(floats first, floats others) {
  return {_mm256_blend_ps(others.v, first.v, 1)};
}
inline float smallest_lane(floats a) {
  __m128 m = _mm_min_ps(_mm256_castps256_ps128(a.v), _mm256_extractf128_ps(a.v, 1));
  m = _mm_min_ps(m, _mm_movehl_ps(m, m));
  m = _mm_min_ss(m, _mm_shuffle_ps(m, m, 1));
  return _mm_cvtss_f32(m);
}
// a * b - c * d, exact where the products stay below 2^52; rounded to float at the end.
inline floats determinant(ints a, ints b, ints c, ints d) {
  const auto half = [](__m128i w, __m128i x, __m128i y, __m128i z) {
    return _mm256_cvtpd_ps(_mm256_sub_pd(_mm256_mul_pd(_mm256_cvtepi32_pd(w), _mm256_cvtepi32_pd(x)),
                                         _mm256_mul_pd(_mm256_cvtepi32_pd(y), _mm256_cvtepi32_pd(z))));
  };
  const auto low = [](ints i) { return _mm256_castsi256_si128(i.v); };
  const auto high = [](ints i) { return _mm256_extracti128_si256(i.v, 1); };
  return {_mm256_set_m128(half(high(a), high(b), high(c), high(d)), half(low(a), low(b), low(c), low(d)))};
}

#else

struct alignas(32) floats {
  float v[8];
};
struct alignas(32) ints {
  std::int32_t v[8];
};

template <class Out, class Make>
inline Out each(const Make& make) {
  Out out;
  for (int k = 0; k < 8; ++k) out.v[k] = make(k);
  return out;
}
inline std::int32_t wrapped(std::int64_t a) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(a)));
}
inline floats load(const float* p) {
  return each<floats>([&](int k) { return p[k]; });
}
inline ints load(const std::int32_t* p) {
  return each<ints>([&](int k) { return p[k]; });
}
inline ints load(const std::uint32_t* p) {
  return each<ints>([&](int k) { return static_cast<std::int32_t>(p[k]); });
}
inline void store(float* p, const floats& a) {
  for (int k = 0; k < 8; ++k) p[k] = a.v[k];
}
inline void store(std::int32_t* p, const ints& a) {
  for (int k = 0; k < 8; ++k) p[k] = a.v[k];
}
inline void store(std::uint32_t* p, const ints& a) {
  for (int k = 0; k < 8; ++k) p[k] = static_cast<std::uint32_t>(a.v[k]);
}
inline floats all(float a) {
  return each<floats>([&](int) { return a; });
}
inline ints all(std::int32_t a) {
  return each<ints>([&](int) { return a; });
}
inline ints count_up() {
  return each<ints>([](int k) { return k; });
}
inline floats operator+(const floats& a, const floats& b) {
  return each<floats>([&](int k) { return a.v[k] + b.v[k]; });
}
inline floats operator-(const floats& a, const floats& b) {
  return each<floats>([&](int k) { return a.v[k] - b.v[k]; });
}
inline floats operator*(const floats& a, const floats& b) {
  return each<floats>([&](int k) { return a.v[k] * b.v[k]; });
}
inline floats operator/(const floats& a, const floats& b) {
  return each<floats>([&](int k) { return a.v[k] / b.v[k]; });
}
inline floats smaller(const floats& a, const floats& b) {
  return each<floats>([&](int k) { return a.v[k] < b.v[k] ? a.v[k] : b.v[k]; });
}
inline floats larger(const floats& a, const floats& b) {
  return each<floats>([&](int k) { return a.v[k] > b.v[k] ? a.v[k] : b.v[k]; });
}
inline floats magnitude(const floats& a) {
  return each<floats>([&](int k) { return __builtin_fabsf(a.v[k]); });
}
inline ints operator>(const floats& a, const floats& b) {
  return each<ints>([&](int k) { return a.v[k] > b.v[k] ? -1 : 0; });
}
inline ints operator>=(const floats& a, const floats& b) {
  return each<ints>([&](int k) { return a.v[k] >= b.v[k] ? -1 : 0; });
}
inline ints operator+(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return wrapped(std::int64_t{a.v[k]} + b.v[k]); });
}
inline ints operator-(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return wrapped(std::int64_t{a.v[k]} - b.v[k]); });
}
inline ints operator*(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return wrapped(std::int64_t{a.v[k]} * b.v[k]); });
}
inline ints operator|(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return a.v[k] | b.v[k]; });
}
inline ints operator&(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return a.v[k] & b.v[k]; });
}
inline ints without(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return a.v[k] & ~b.v[k]; });
}
inline ints smaller(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return a.v[k] < b.v[k] ? a.v[k] : b.v[k]; });
}
inline ints larger(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return a.v[k] > b.v[k] ? a.v[k] : b.v[k]; });
}
inline ints operator>(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return a.v[k] > b.v[k] ? -1 : 0; });
}
inline ints operator==(const ints& a, const ints& b) {
  return each<ints>([&](int k) { return a.v[k] == b.v[k] ? -1 : 0; });
}
template <int bits>
inline ints shift_right(const ints& a) {
  return each<ints>([&](int k) { return a.v[k] >> bits; });
}
// Like the instructions: what does not fit becomes the smallest number.
inline std::int32_t checked_int(float a) {
  return a >= -2147483648.0f && a < 2147483648.0f ? static_cast<std::int32_t>(a) : INT32_MIN;
}
inline ints rounded(const floats& a) {
  return each<ints>([&](int k) { return checked_int(__builtin_rintf(a.v[k])); });
}
inline ints truncated(const floats& a) {
  return each<ints>([&](int k) { return checked_int(a.v[k]); });
}
inline floats to_floats(const ints& a) {
  return each<floats>([&](int k) { return static_cast<float>(a.v[k]); });
}
inline floats choose(const ints& mask, const floats& yes, const floats& no) {
  return each<floats>([&](int k) { return mask.v[k] < 0 ? yes.v[k] : no.v[k]; });
}
inline ints choose(const ints& mask, const ints& yes, const ints& no) {
  return each<ints>([&](int k) { return mask.v[k] < 0 ? yes.v[k] : no.v[k]; });
}
inline std::uint32_t sign_bits(const ints& a) {
  std::uint32_t bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<std::uint32_t>(a.v[k] < 0) << k;
  return bits;
}
inline std::uint32_t sign_bits(const floats& a) {
  std::uint32_t bits = 0;
  for (int k = 0; k < 8; ++k) bits |= static_cast<std::uint32_t>(__builtin_signbit(a.v[k]) != 0) << k;
  return bits;
}
inline floats floor_of(const floats& a) {
  return each<floats>([&](int k) { return __builtin_floorf(a.v[k]); });
}
inline ints bytes_at(const std::uint8_t* base, const ints& offset) {
  return each<ints>([&](int k) { return std::int32_t{base[offset.v[k]]}; });
}
inline floats rotated(const floats& a) {
  return each<floats>([&](int k) { return a.v[(k + 7) % 8]; });
}
inline floats first_lane_from(const floats& first, const floats& others) {
  return each<floats>([&](int k) { return k == 0 ? first.v[0] : others.v[k]; });
}
inline float smallest_lane(const floats& a) {
  float m = a.v[0];
  for (int k = 1; k < 8; ++k) m = a.v[k] < m ? a.v[k] : m;
  return m;
}
inline floats determinant(const ints& a, const ints& b, const ints& c, const ints& d) {
  return each<floats>([&](int k) {
    return static_cast<float>(static_cast<double>(a.v[k]) * b.v[k] - static_cast<double>(c.v[k]) * d.v[k]);
  });
}

#endif

}  // namespace
}  // namespace sightcell::bake::cpu
