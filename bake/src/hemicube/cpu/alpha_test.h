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

// What the opacity map of a triangle knows.
struct known_opacity {
  std::uint32_t lanes = 0, passing = 0;  // a bit per lane: is known, and passes
};

// Looks eight points up in the opacity map of a triangle. Computes the formula of scene::opacity_maps::at().
inline known_opacity look_up(const masked_triangle& t, const std::uint8_t* parts, floats u, floats v) {
  const floats side = all(static_cast<float>(t.side)), zero = all(0.0f);
  const ints inside = (u >= zero) & (v >= zero) & (all(1.0f) >= u + v);
  const floats across = u * side, up = v * side;
  const ints last = all(static_cast<std::int32_t>(t.side - 1));
  const ints column = smaller(truncated(choose(inside, across, zero)), last),
             row = smaller(truncated(choose(inside, up, zero)), last);
  const floats beyond = (across - to_floats(column)) + (up - to_floats(row));
  const ints square = row * all(static_cast<std::int32_t>(t.side)) + column;
  const ints part = square + square + choose(beyond > all(1.0f), all(1), all(0));
  const ints at = choose(inside, part, all(0)) + all(static_cast<std::int32_t>(t.first_part));
  const ints found = two_bytes_at(parts, at) & all(0xFF);
  const std::uint32_t passing = sign_bits(found == all(static_cast<std::int32_t>(scene::opacity::passes)));
  const std::uint32_t failing = sign_bits(found == all(static_cast<std::int32_t>(scene::opacity::fails)));
  const std::uint32_t in = sign_bits(inside);
  return {(passing | failing) & in, passing & in};
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
