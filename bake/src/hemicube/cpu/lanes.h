#pragma once
// Vectors of eight floats or eight 32-bit integers on top of Google Highway. The instruction set that the file is
// compiled for determines how many Highway vectors make up eight lanes: one of eight lanes with AVX2, two of four with
// SSE4 and NEON, eight of one in the portable kernel.
//
// Every operation rounds once per lane as IEEE 754 prescribes, and no multiplication is fused with an addition, so all
// instruction sets give the same bits. Where the result of a Highway function depends on the instruction set (minimum
// of NaN or of two zeros), this file defines the result.
//
// Everything here is in an unnamed namespace: files compiled for different instruction sets include it, and the linker
// must not replace a function of one by that of another.
// Highway's AVX2, SSE4 and NEON targets without the extensions that the kernels do not use. So -mavx2 and -msse4.2
// suffice as compiler flags, and a kernel runs on each processor with that instruction set. The first line also keeps
// fused multiply-add out.
#define HWY_DISABLE_BMI2_FMA
#define HWY_DISABLE_F16C
#define HWY_DISABLE_PCLMUL_AES
#define TOOLCHAIN_MISS_SYS_AUXV_H  // ARM64: no target attribute for AES, which prevents inlining
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <utility>

namespace sightcell::bake::cpu {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using float_tag = hn::CappedTag<float, 8>;
using int_tag = hn::RebindToSigned<float_tag>;

constexpr std::size_t vector_lanes = hn::MaxLanes(float_tag());
constexpr std::size_t parts = 8 / vector_lanes;  // Highway vectors per eight lanes
constexpr bool is_x86_vector = HWY_ARCH_X86 && vector_lanes > 1;

struct floats {
  hn::Vec<float_tag> v[parts];
};
// Integers, and masks: comparisons set all bits of a lane or none. choose() and sign_bits() use the sign bit only.
struct ints {
  hn::Vec<int_tag> v[parts];
};

// Calls make(p) for each Highway vector. No loop, because compilers would keep the array in memory.
template <class Out, class Make, std::size_t... p>
HWY_INLINE Out each(const Make& make, std::index_sequence<p...>) {
  return {{make(p)...}};
}
template <class Out, class Make>
HWY_INLINE Out each(const Make& make) {
  return each<Out>(make, std::make_index_sequence<parts>());
}

HWY_INLINE floats load(const float* from) {
  return each<floats>([=](std::size_t p) { return hn::Load(float_tag(), from + p * vector_lanes); });
}
HWY_INLINE ints load(const std::int32_t* from) {
  return each<ints>([=](std::size_t p) { return hn::Load(int_tag(), from + p * vector_lanes); });
}
HWY_INLINE ints load(const std::uint32_t* from) {
  return load(reinterpret_cast<const std::int32_t*>(from));
}
HWY_INLINE void store(float* to, const floats& a) {
  for (std::size_t p = 0; p < parts; ++p) hn::Store(a.v[p], float_tag(), to + p * vector_lanes);
}
HWY_INLINE void store(std::int32_t* to, const ints& a) {
  for (std::size_t p = 0; p < parts; ++p) hn::Store(a.v[p], int_tag(), to + p * vector_lanes);
}
HWY_INLINE void store(std::uint32_t* to, const ints& a) {
  store(reinterpret_cast<std::int32_t*>(to), a);
}
HWY_INLINE floats all(float a) {
  return each<floats>([=](std::size_t) { return hn::Set(float_tag(), a); });
}
HWY_INLINE ints all(std::int32_t a) {
  return each<ints>([=](std::size_t) { return hn::Set(int_tag(), a); });
}
HWY_INLINE ints count_up() {  // 0, 1 ... 7
  alignas(32) static constexpr std::int32_t numbers[8] = {0, 1, 2, 3, 4, 5, 6, 7};
  return load(numbers);
}

HWY_INLINE floats as_floats(const ints& a) {  // the same bits
  return each<floats>([&](std::size_t p) { return hn::BitCast(float_tag(), a.v[p]); });
}

HWY_INLINE floats operator+(const floats& a, const floats& b) {
  return each<floats>([&](std::size_t p) { return hn::Add(a.v[p], b.v[p]); });
}
HWY_INLINE floats operator-(const floats& a, const floats& b) {
  return each<floats>([&](std::size_t p) { return hn::Sub(a.v[p], b.v[p]); });
}
HWY_INLINE floats operator*(const floats& a, const floats& b) {
  return each<floats>([&](std::size_t p) { return hn::Mul(a.v[p], b.v[p]); });
}
HWY_INLINE floats operator/(const floats& a, const floats& b) {
  return each<floats>([&](std::size_t p) { return hn::Div(a.v[p], b.v[p]); });
}
// a < b ? a : b, hence b where one of them is NaN. On x86 this is one instruction, to which Highway's Min compiles. On
// other targets Min treats NaN and the signs of zeros differently.
HWY_INLINE floats smaller(const floats& a, const floats& b) {
  return each<floats>([&](std::size_t p) {
    if constexpr (is_x86_vector) return hn::Min(a.v[p], b.v[p]);
    return hn::IfThenElse(hn::Lt(a.v[p], b.v[p]), a.v[p], b.v[p]);
  });
}
// a > b ? a : b.
HWY_INLINE floats larger(const floats& a, const floats& b) {
  return each<floats>([&](std::size_t p) {
    if constexpr (is_x86_vector) return hn::Max(a.v[p], b.v[p]);
    return hn::IfThenElse(hn::Gt(a.v[p], b.v[p]), a.v[p], b.v[p]);
  });
}
HWY_INLINE floats magnitude(const floats& a) {
  return each<floats>([&](std::size_t p) { return hn::Abs(a.v[p]); });
}
HWY_INLINE floats floor_of(const floats& a) {
  return each<floats>([&](std::size_t p) { return hn::Floor(a.v[p]); });
}
HWY_INLINE ints operator>(const floats& a, const floats& b) {
  return each<ints>(
      [&](std::size_t p) { return hn::BitCast(int_tag(), hn::VecFromMask(float_tag(), hn::Gt(a.v[p], b.v[p]))); });
}
HWY_INLINE ints operator>=(const floats& a, const floats& b) {
  return each<ints>(
      [&](std::size_t p) { return hn::BitCast(int_tag(), hn::VecFromMask(float_tag(), hn::Ge(a.v[p], b.v[p]))); });
}

HWY_INLINE ints operator+(const ints& a, const ints& b) {  // modulo 2^32, like - and *
  return each<ints>([&](std::size_t p) { return hn::Add(a.v[p], b.v[p]); });
}
HWY_INLINE ints operator-(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::Sub(a.v[p], b.v[p]); });
}
HWY_INLINE ints operator*(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::Mul(a.v[p], b.v[p]); });
}
HWY_INLINE ints operator|(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::Or(a.v[p], b.v[p]); });
}
HWY_INLINE ints operator&(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::And(a.v[p], b.v[p]); });
}
HWY_INLINE ints without(const ints& a, const ints& b) {  // a & ~b
  return each<ints>([&](std::size_t p) { return hn::AndNot(b.v[p], a.v[p]); });
}
HWY_INLINE ints smaller(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::Min(a.v[p], b.v[p]); });
}
HWY_INLINE ints larger(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::Max(a.v[p], b.v[p]); });
}
HWY_INLINE ints operator>(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::VecFromMask(int_tag(), hn::Gt(a.v[p], b.v[p])); });
}
HWY_INLINE ints operator==(const ints& a, const ints& b) {
  return each<ints>([&](std::size_t p) { return hn::VecFromMask(int_tag(), hn::Eq(a.v[p], b.v[p])); });
}
template <int bits>
HWY_INLINE ints shift_right(const ints& a) {  // keeps the sign
  return each<ints>([&](std::size_t p) { return hn::ShiftRight<bits>(a.v[p]); });
}

// Conversions to integers. The result of a value that is out of range depends on the instruction set. Callers ignore
// such lanes or clamp the values first.
HWY_INLINE ints rounded(const floats& a) {  // to nearest, halves to even
  return each<ints>([&](std::size_t p) {
// Highway's NearestInt saturates, which costs four more instructions on x86.
#if HWY_TARGET == HWY_AVX2
    return hn::Vec<int_tag>{_mm256_cvtps_epi32(a.v[p].raw)};
#elif HWY_TARGET == HWY_SSE4
    return hn::Vec<int_tag>{_mm_cvtps_epi32(a.v[p].raw)};
#else
    return hn::NearestInt(a.v[p]);
#endif
  });
}
HWY_INLINE ints truncated(const floats& a) {  // towards zero
  return each<ints>([&](std::size_t p) { return hn::ConvertTo(int_tag(), a.v[p]); });
}
HWY_INLINE floats to_floats(const ints& a) {
  return each<floats>([&](std::size_t p) { return hn::ConvertTo(float_tag(), a.v[p]); });
}

// The mask of the lanes whose sign bit is set. Masks are sign bits on x86, and whole lanes elsewhere.
HWY_INLINE hn::Mask<float_tag> signs(hn::Vec<int_tag> a) {
  if constexpr (!is_x86_vector) a = hn::BroadcastSignBit(a);
  return hn::MaskFromVec(hn::BitCast(float_tag(), a));
}
HWY_INLINE floats choose(const ints& mask, const floats& yes, const floats& no) {
  return each<floats>([&](std::size_t p) { return hn::IfThenElse(signs(mask.v[p]), yes.v[p], no.v[p]); });
}
HWY_INLINE ints choose(const ints& mask, const ints& yes, const ints& no) {
  const floats chosen = choose(mask, as_floats(yes), as_floats(no));
  return each<ints>([&](std::size_t p) { return hn::BitCast(int_tag(), chosen.v[p]); });
}
HWY_INLINE std::uint32_t sign_bits(const ints& a) {  // of lane k in bit k
  std::uint32_t bits = 0;
  for (std::size_t p = 0; p < parts; ++p) {
    std::uint8_t some = 0;
    hn::StoreMaskBits(float_tag(), signs(a.v[p]), &some);
    bits |= std::uint32_t{some} << (p * vector_lanes);
  }
  return bits;
}
HWY_INLINE std::uint32_t sign_bits(const floats& a) {
  return sign_bits(each<ints>([&](std::size_t p) { return hn::BitCast(int_tag(), a.v[p]); }));
}

// The four bytes from base + offset on, the first one lowest.
HWY_INLINE ints four_bytes_at(const std::uint8_t* base, const ints& offset) {
#if HWY_TARGET == HWY_AVX2
  return {{hn::GatherOffset(int_tag(), reinterpret_cast<const std::int32_t*>(base), offset.v[0])}};
#else
  alignas(32) std::int32_t at[8];
  store(at, offset);
  for (std::int32_t& a : at) {
    const std::uint8_t* from = base + a;
    a = static_cast<std::int32_t>(std::uint32_t{from[0]} | std::uint32_t{from[1]} << 8 | std::uint32_t{from[2]} << 16 |
                                  std::uint32_t{from[3]} << 24);
  }
  return load(at);
#endif
}

// Lane k is lane k - 1 of a; lane 0 is lane 7 of before.
HWY_INLINE floats shifted_in(const floats& before, const floats& a) {
  return each<floats>([&](std::size_t p) {
    const auto low = p == 0 ? before.v[parts - 1] : a.v[p == 0 ? 0 : p - 1];
#if HWY_TARGET == HWY_SCALAR
    return low;
#elif HWY_TARGET == HWY_AVX2
    return hn::CombineShiftRightBytes<12>(float_tag(), a.v[p], hn::ConcatLowerUpper(float_tag(), a.v[p], low));
#else
    return hn::CombineShiftRightBytes<12>(float_tag(), a.v[p], low);
#endif
  });
}

HWY_INLINE float smallest_lane(const floats& a) {
  auto least = a.v[0];
  for (std::size_t p = 1; p < parts; ++p) least = hn::Min(least, a.v[p]);
  return hn::GetLane(hn::MinOfLanes(float_tag(), least));
}

// a * b - c * d, exact where the products stay below 2^52; rounded to float at the end.
HWY_INLINE floats determinant(const ints& a, const ints& b, const ints& c, const ints& d) {
  const auto of = [](auto w, auto x, auto y, auto z) __attribute__((always_inline)) {
    const hn::Rebind<double, hn::DFromV<decltype(w)>> wide;
    const hn::Rebind<float, decltype(wide)> narrow;
    return hn::DemoteTo(narrow, hn::Sub(hn::Mul(hn::PromoteTo(wide, w), hn::PromoteTo(wide, x)),
                                        hn::Mul(hn::PromoteTo(wide, y), hn::PromoteTo(wide, z))));
  };
  return each<floats>([&](std::size_t p) __attribute__((always_inline)) {
#if HWY_TARGET == HWY_SCALAR
    return of(a.v[p], b.v[p], c.v[p], d.v[p]);
#else
    const hn::Half<int_tag> half;
    const auto high = [&](const ints& i) { return hn::UpperHalf(half, i.v[p]); };
    const auto low = [&](const ints& i) { return hn::LowerHalf(half, i.v[p]); };
    return hn::Combine(float_tag(), of(high(a), high(b), high(c), high(d)), of(low(a), low(b), low(c), low(d)));
#endif
  });
}

}  // namespace
}  // namespace sightcell::bake::cpu
