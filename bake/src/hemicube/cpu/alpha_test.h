#pragma once
// Alpha test of eight pixels at a time. It computes the formula of bake/scene/src/alpha_mask.cpp in the same order, so
// that rays and hemicubes get the same result.
#include "hemicube/cpu/kernel.h"
#include "hemicube/cpu/lanes.h"

namespace sightcell::bake::cpu {
namespace {

// The texel below a coordinate, counted from the border of the mask, and the weight of the next one.
struct between {
  ints below;
  floats toward_next;
};

inline floats folded(floats coordinate, scene::wrap mode) {
  if (mode == scene::wrap::clamp) return smaller(larger(coordinate, all(0.0f)), all(1.0f));
  if (mode == scene::wrap::mirror)
    return magnitude(coordinate - all(2.0f) * floor_of((coordinate + all(1.0f)) * all(0.5f)));
  return coordinate - floor_of(coordinate);
}

// Lanes outside of the triangle may have any coordinate, also infinity and NaN. The texels are inside the mask anyway.
inline between texels_at(floats coordinate, std::uint32_t size, scene::wrap mode) {
  const floats last = all(static_cast<float>(size - 1));
  const floats place = folded(coordinate, mode) * all(static_cast<float>(size)) - all(0.5f);
  const floats below = larger(smaller(floor_of(place), last), all(-1.0f));
  return {truncated(below) + all(1), place - below};
}

// Returns a bit per lane whose alpha passes. u, v: weights of the second and the third corner.
inline std::uint32_t alpha_passes(const masked_triangle& t, const mask_texels& mask, const std::uint8_t* texels,
                                  floats u, floats v) {
  const auto at = [&](const float(&corner)[3]) {
    return all(corner[0]) + all(corner[1] - corner[0]) * u + all(corner[2] - corner[0]) * v;
  };
  const between x = texels_at(at(t.u), mask.width, mask.wrap_u), y = texels_at(at(t.v), mask.height, mask.wrap_v);
  const ints stride = all(static_cast<std::int32_t>(mask.width + 2));
  const ints lower = all(static_cast<std::int32_t>(mask.first)) + y.below * stride + x.below;
  const auto across = [&](ints first) {
    const ints two = two_bytes_at(texels, first);
    const floats left = to_floats(two & all(0xFF)), right = to_floats(shift_right<8>(two));
    return left + (right - left) * x.toward_next;
  };
  const floats low = across(lower), high = across(lower + stride);
  const floats alpha = (low + (high - low) * y.toward_next) / all(255.0f) * at(t.alpha);
  return sign_bits(alpha >= all(mask.cutoff));
}

}  // namespace
}  // namespace sightcell::bake::cpu
