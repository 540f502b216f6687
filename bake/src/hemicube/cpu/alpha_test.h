#pragma once
// Alpha test of the pixels of a tile (rule 1 of docs/method/visibility-rules.md). Texture coordinates are ratios of two
// linear functions of the pixel. The lookup computes the formula of bake/scene/src/alpha_mask.cpp in the same order, so
// that rays and hemicubes get the same result but for the rounding of the coordinates.
#include "hemicube/cpu/lanes.h"
#include "hemicube/cpu/pixel_plane.h"

namespace sightcell::bake::cpu {
namespace {

// Of a masked triangle: texture coordinate u is u / weight, and so on. Sums over the corners of their values times
// their weights, which are edges in homogeneous coordinates.
struct alpha_planes {
  pixel_plane weight, u, v, alpha;
};

inline double at(const pixel_plane& p, double x, double y) {
  return p.a * x + p.b * y + p.c;
}

inline pixel_plane sum_of(const pixel_plane (&weights)[3], const float (&values)[3]) {
  const double x = static_cast<double>(values[0]), y = static_cast<double>(values[1]),
               z = static_cast<double>(values[2]);
  return {weights[0].a * x + weights[1].a * y + weights[2].a * z,
          weights[0].b * x + weights[1].b * y + weights[2].b * z,
          weights[0].c * x + weights[1].c * y + weights[2].c * z};
}

inline alpha_planes planes_of(const face_frame& face, const masked_triangle& t, bool varies, const corner3 (&v)[3]) {
  pixel_plane weights[3];
  for (int k = 0; k < 3; ++k) weights[k] = per_pixel(face, cross(v[(k + 1) % 3], v[(k + 2) % 3]));
  constexpr float ones[3] = {1.0f, 1.0f, 1.0f};
  alpha_planes p{sum_of(weights, ones), sum_of(weights, t.u), sum_of(weights, t.v), {}};
  if (varies) p.alpha = sum_of(weights, t.alpha);
  return p;
}

enum class alpha_result { unknown, passes, fails };

// A range of texture coordinates on one axis, and the blocks of its lookups; both ends included.
struct coordinate_range {
  double low, high;
};
struct block_range {
  std::uint32_t first, last;
};

inline double floor_of(double v) {  // of numbers below 2^62
  const auto whole = static_cast<double>(static_cast<std::int64_t>(v));
  return whole > v ? whole - 1.0 : whole;
}

// Folds a range into 0 .. 1. May return more than its image.
inline coordinate_range folded(coordinate_range r, scene::wrap mode) {
  if (mode == scene::wrap::clamp) {
    const auto limited = [](double v) { return v > 0.0 ? (v < 1.0 ? v : 1.0) : 0.0; };
    return {limited(r.low), limited(r.high)};
  }
  const double turn = floor_of(r.low);
  if (!(r.high < turn + 1.0)) return {0.0, 1.0};
  if (mode == scene::wrap::mirror && (static_cast<std::int64_t>(turn) & 1) != 0)
    return {turn + 1.0 - r.high, turn + 1.0 - r.low};
  return {r.low - turn, r.high - turn};
}

inline block_range blocks_of(coordinate_range r, std::uint32_t size, scene::wrap mode) {
  // More than single precision loses in the lookup. Added before folding: the next number may be on the other side.
  const double margin = 0.01 / size + 1e-6 * (1.0 + __builtin_fabs(r.low) + __builtin_fabs(r.high));
  const coordinate_range f = folded({r.low - margin, r.high + margin}, mode);
  // The number of the quad is floor(coordinate size - 1/2) + 1.
  const auto first = static_cast<std::uint32_t>(f.low * size + 0.5),
             last = static_cast<std::uint32_t>(f.high * size + 0.5);
  return {(first < size ? first : size) / quads_per_block, (last < size ? last : size) / quads_per_block};
}

// Returns what the alpha tests of all pixels from (x0, y0) to (x1, y1) have in common, as far as block counts show.
inline alpha_result known_between(const scene_view& scene, const masked_triangle& t, const alpha_planes& p,
                                  std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
  const alpha_test& test = scene.tests[t.test];
  if (test.blocks_across == 0) return alpha_result::unknown;
  const double x = 0.5 * (x0 + x1) + 0.5, y = 0.5 * (y0 + y1) + 0.5, half_x = 0.5 * (x1 - x0), half_y = 0.5 * (y1 - y0);
  const double weight = at(p.weight, x, y);
  const double least =
      __builtin_fabs(weight) - (__builtin_fabs(p.weight.a) * half_x + __builtin_fabs(p.weight.b) * half_y);
  // Near the horizon of the triangle weights are rounding noise.
  if (!(least > 0.25 * __builtin_fabs(weight))) return alpha_result::unknown;
  const double per_weight = 1.0 / weight, per_least = 1.0 / least;
  // u(x) - u(center) is a linear function that is 0 at the center, divided by the weight.
  const auto range = [&](const pixel_plane& of) -> coordinate_range {
    const double center = at(of, x, y) * per_weight;
    const double reach =
        (__builtin_fabs(of.a - center * p.weight.a) * half_x + __builtin_fabs(of.b - center * p.weight.b) * half_y) *
        per_least;
    return {center - reach, center + reach};
  };
  const coordinate_range u = range(p.u), v = range(p.v);
  constexpr double most = 1e6;
  if (!(u.low > -most && u.high < most && v.low > -most && v.high < most)) return alpha_result::unknown;
  const block_range across = blocks_of(u, test.width, test.wrap_u), up = blocks_of(v, test.height, test.wrap_v);
  const std::uint32_t stride = test.blocks_across + 1;
  const block_counts* low = scene.counts + test.first_count + up.first * stride;
  const block_counts* high = scene.counts + test.first_count + (up.last + 1) * stride;
  if (high[across.last + 1].may_pass + low[across.first].may_pass ==
      high[across.first].may_pass + low[across.last + 1].may_pass)
    return alpha_result::fails;
  if (high[across.last + 1].may_fail + low[across.first].may_fail ==
      high[across.first].may_fail + low[across.last + 1].may_fail)
    return alpha_result::passes;
  return alpha_result::unknown;
}

// A plane in a tile: its value at the first pixel, and steps per pixel.
struct tile_plane {
  float first, step_x, step_y;

  floats at(const floats& x, const floats& y) const { return (all(first) + all(step_x) * x) + all(step_y) * y; }
};

struct alpha_tile {
  tile_plane weight, u, v, alpha;
};

inline alpha_tile tile_of(const alpha_planes& p, std::uint32_t x, std::uint32_t y) {
  const auto plane = [&](const pixel_plane& of) -> tile_plane {
    return {static_cast<float>(at(of, x + 0.5, y + 0.5)), static_cast<float>(of.a), static_cast<float>(of.b)};
  };
  return {plane(p.weight), plane(p.u), plane(p.v), plane(p.alpha)};
}

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

// Returns a bit for each of eight pixels of a tile whose alpha passes. x, y: the pixels, from the first one of the
// tile.
inline std::uint32_t alpha_passes(const scene_view& scene, const alpha_test& test, const alpha_tile& tile,
                                  const floats& x_in_tile, const floats& y_in_tile) {
  const floats per_weight = all(1.0f) / tile.weight.at(x_in_tile, y_in_tile);
  const between x = texels_at(tile.u.at(x_in_tile, y_in_tile) * per_weight, test.width, test.wrap_u),
                y = texels_at(tile.v.at(x_in_tile, y_in_tile) * per_weight, test.height, test.wrap_v);
  const ints quads = y.below * all(static_cast<std::int32_t>(test.width + 2)) + x.below;
  const ints bytes = four_bytes_at(scene.texels + test.first, quads + quads), byte = all(0xFF);
  const auto beside = [&](const ints& left, const ints& right) {
    const floats from = to_floats(left & byte);
    return from + (to_floats(right & byte) - from) * x.toward_next;
  };
  const floats low = beside(bytes, shift_right<16>(bytes)),
               high = beside(shift_right<8>(bytes), shift_right<24>(bytes));
  const floats number = low + (high - low) * y.toward_next;
  if (!test.varies) return sign_bits(number >= all(test.threshold));
  const floats alpha = tile.alpha.at(x_in_tile, y_in_tile) * per_weight;
  return sign_bits(number / all(255.0f) * alpha >= all(test.cutoff));
}

// Pixels of a tile: bit 8 y + x is pixel (x, y).
using tile_bits = std::uint64_t;

inline std::uint32_t row_of(tile_bits bits, std::uint32_t y) {
  return static_cast<std::uint32_t>(bits >> (8 * y)) & 0xFFu;
}

// Returns those of the pixels whose alpha passes.
inline tile_bits alpha_passes(const scene_view& scene, const alpha_test& test, const alpha_tile& tile, tile_bits bits) {
  std::int32_t count = 0;
  alignas(32) std::int32_t pixels[tile_pixels];
  for (tile_bits left = bits; left != 0; left &= left - 1) pixels[count++] = __builtin_ctzll(left);
  for (std::int32_t k = count; k % 8 != 0; ++k) pixels[k] = pixels[count - 1];
  tile_bits passes = 0;
  for (std::int32_t k = 0; k < count; k += 8) {
    const ints eight = load(pixels + k);
    std::uint32_t found = alpha_passes(scene, test, tile, to_floats(eight & all(7)), to_floats(shift_right<3>(eight)));
    for (; found != 0; found &= found - 1) passes |= tile_bits{1} << pixels[k + __builtin_ctz(found)];
  }
  return passes;
}

}  // namespace
}  // namespace sightcell::bake::cpu
