#pragma once
// Alpha test of eight pixels at a time. It computes the formula of bake/scene/src/alpha_mask.cpp in the same order, so
// that rays and hemicubes get the same result.
#include "hemicube/cpu/kernel.h"
#include "hemicube/cpu/lanes.h"

namespace sightcell::bake::cpu {
namespace {

struct between {
  ints first, second;
  floats toward_second;
};

inline floats folded(floats coordinate, scene::wrap mode) {
  if (mode == scene::wrap::clamp) return smaller(larger(coordinate, all(0.0f)), all(1.0f));
  if (mode == scene::wrap::mirror)
    return magnitude(coordinate - all(2.0f) * floor_of((coordinate + all(1.0f)) * all(0.5f)));
  return coordinate - floor_of(coordinate);
}

// Lanes outside of the triangle may have any coordinate, also infinity and NaN. The texels are inside the mask anyway.
inline between texels_at(floats coordinate, std::uint32_t size, scene::wrap mode) {
  const floats place = folded(coordinate, mode) * all(static_cast<float>(size)) - all(0.5f);
  const floats below = floor_of(place);
  const ints last = all(static_cast<std::int32_t>(size - 1)), zero = all(0);
  const bool repeat = mode == scene::wrap::repeat;
  const ints before = all(0.0f) > below;
  const ints inside = truncated(larger(smaller(below, to_floats(last)), all(0.0f)));
  const ints first = choose(before, repeat ? last : zero, inside);
  const ints second = choose(before, zero, choose(first == last, repeat ? zero : last, first + all(1)));
  return {first, second, place - below};
}

// Returns a bit per lane whose alpha passes. u, v: weights of the second and the third corner.
inline std::uint32_t alpha_passes(const masked_triangle& t, const mask_texels& mask, const std::uint8_t* texels,
                                  floats u, floats v) {
  const auto at = [&](const float(&corner)[3]) {
    return all(corner[0]) + all(corner[1] - corner[0]) * u + all(corner[2] - corner[0]) * v;
  };
  const between x = texels_at(at(t.u), mask.width, mask.wrap_u), y = texels_at(at(t.v), mask.height, mask.wrap_v);
  const ints width = all(static_cast<std::int32_t>(mask.width)), base = all(static_cast<std::int32_t>(mask.first));
  const auto texel = [&](ints column, ints row) { return to_floats(bytes_at(texels, base + row * width + column)); };
  const auto across = [&](ints row) {
    const floats left = texel(x.first, row);
    return left + (texel(x.second, row) - left) * x.toward_second;
  };
  const floats low = across(y.first), high = across(y.second);
  const floats alpha = (low + (high - low) * y.toward_second) / all(255.0f) * at(t.alpha);
  return sign_bits(alpha >= all(mask.cutoff));
}

}  // namespace
}  // namespace sightcell::bake::cpu
