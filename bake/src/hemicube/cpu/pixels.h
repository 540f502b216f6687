#pragma once
// Processes the pixels of a tile that a triangle covers. Depending on the pass they are drawn, drawn where the alpha
// test passes, or counted where no occluder is in front.
#include "hemicube/cpu/alpha_test.h"
#include "hemicube/cpu/tiles.h"

namespace sightcell::bake::cpu {
namespace {

enum class pass { opaque, masked, see_through };

constexpr std::int32_t sub_pixel = 1 << 16;  // fixed-point units per pixel
constexpr float near_plane = 0.001f;         // meters; the same as hemicube_near

// A plane of inverse depths: value at the center of the tile's first pixel, and steps per pixel. Values are clamped to
// the range of the corners, because the slopes of a sliver are rounding noise.
struct depth_plane {
  float base, step_x, step_y, least, most;
};

// Barycentric weights of a pixel, from edges in homogeneous coordinates: weight k is (a[k], b[k], c[k]) . (px, py, 1),
// divided by the sum of all three. Computed for masked triangles only.
struct corner_weights {
  double a[3], b[3], c[3];
};

struct draw_state {
  const face_frame& face;
  const tile_image& image;
  const polygon_counter& counter;
  const scene_view& scene;
  std::uint32_t id = 0;            // of the current triangle
  std::uint32_t masked = nothing;  // index of the triangle in world_geometry::masked
  corner_weights weights{};        // only if it is masked
};

// Rule 1 (docs/method/visibility-rules.md). Returns the pixels of bits, a row of a tile, whose alpha test passes.
inline std::uint32_t passing(const draw_state& s, std::uint32_t bits, std::uint32_t x, std::uint32_t y) {
  floats w[3];
  for (int k = 0; k < 3; ++k) {
    const double first = s.weights.a[k] * (static_cast<double>(x) + 0.5) +
                         s.weights.b[k] * (static_cast<double>(y) + 0.5) + s.weights.c[k];
    w[k] = all(static_cast<float>(first)) + all(static_cast<float>(s.weights.a[k])) * to_floats(count_up());
  }
  const floats sum = w[0] + w[1] + w[2];
  const masked_triangle& t = s.scene.masked_triangles[s.masked];
  return bits & alpha_passes(t, s.scene.masks[t.mask], s.scene.texels, w[1] / sum, w[2] / sum);
}

// Returns whether the opacity map of the triangle fails everywhere between pixel (x0, y0) and pixel (x1, y1). Where it
// does, passing() returns 0 for all pixels between them that the triangle covers.
inline bool fails_between(const draw_state& s, std::uint32_t x0, std::uint32_t y0, std::uint32_t x1, std::uint32_t y1) {
  const masked_triangle& t = s.scene.masked_triangles[s.masked];
  if (t.side == 0) return false;
  // The corners of the rectangle. Weights divided by their sum are largest and smallest there.
  alignas(32) static constexpr float right[8] = {0, 1, 0, 1, 0, 1, 0, 1}, upper[8] = {0, 0, 1, 1, 0, 0, 1, 1};
  const floats across = load(right) * all(static_cast<float>(x1 - x0)),
               up = load(upper) * all(static_cast<float>(y1 - y0));
  floats w[3];
  for (int k = 0; k < 3; ++k) {
    const double first = s.weights.a[k] * (static_cast<double>(x0) + 0.5) +
                         s.weights.b[k] * (static_cast<double>(y0) + 0.5) + s.weights.c[k];
    w[k] = all(static_cast<float>(first)) + all(static_cast<float>(s.weights.a[k])) * across +
           all(static_cast<float>(s.weights.b[k])) * up;
  }
  const floats sum = w[0] + w[1] + w[2];
  // Near the horizon of the triangle the sum is rounding noise.
  const floats most = larger(larger(magnitude(w[0]), magnitude(w[1])), magnitude(w[2]));
  const std::uint32_t negative = sign_bits(sum);
  if ((negative != 0 && negative != 0xFFu) || sign_bits(magnitude(sum) > most * all(1e-3f)) != 0xFFu) return false;

  const auto side = static_cast<std::int32_t>(t.side), stride = side + 1;
  struct range {
    std::int32_t first, end;  // squares
  };
  const auto squares = [&](const floats& at) -> range {
    constexpr float margin = 1e-3f;  // well above the rounding of weights
    const float low = smallest_lane(at) - margin, high = margin - smallest_lane(all(0.0f) - at);
    const auto limited = [](float v) { return v > 0.0f ? (v < 1.0f ? v : 1.0f) : 0.0f; };
    const auto first = static_cast<std::int32_t>(limited(low) * static_cast<float>(side));
    const auto last = static_cast<std::int32_t>(limited(high) * static_cast<float>(side));
    return {first < side ? first : side - 1, last < side ? last + 1 : side};
  };
  const range u = squares(w[1] / sum), v = squares(w[2] / sum);
  const std::uint32_t* counts = s.scene.open_counts + t.first_count;
  return counts[v.end * stride + u.end] + counts[v.first * stride + u.first] ==
         counts[v.end * stride + u.first] + counts[v.first * stride + u.end];
}

inline ints mask_of(std::uint32_t bits) {
  alignas(32) static constexpr std::int32_t powers[8] = {1, 2, 4, 8, 16, 32, 64, 128};
  const ints bit = load(powers);
  return (all(static_cast<std::int32_t>(bits)) & bit) == bit;
}

// Rule 2: a see-through polygon (a non-occluder) is visible up to a certain distance behind an occluder. This is the
// smallest such distance, for a line of sight in the corner of an image: 0.2 mm / sqrt(3) along the axis, or 2e-5 of
// the depth.
inline floats behind_by_reach(floats q) {
  const floats reach = larger(all(1.15e-4f) * q, all(2e-5f));
  return q / (all(1.0f) + reach);
}

inline void count_row(const draw_state& s, std::uint32_t bits, std::uint32_t x, std::uint32_t y) {
  if (y >= s.face.height || x >= s.face.width) return;
  if (x + tile_size > s.face.width) bits &= 0xFFu >> (x + tile_size - s.face.width);
  if (bits != 0 && s.masked != nothing) bits = passing(s, bits, x, y);
  if (bits == 0) return;
  count(s.counter, s.id, static_cast<std::uint32_t>(__builtin_popcount(bits)),
        atlas_pixel(s.face, x + static_cast<std::uint32_t>(__builtin_ctz(bits)), y));
}

// Processes rows j0 to j1 of a tile. The sign bits of outside(j) mark the pixels that the triangle does not cover.
template <pass kind, class Outside>
inline void cover_rows(const draw_state& s, std::uint32_t tile, std::uint32_t tile_x, std::uint32_t tile_y,
                       std::uint32_t j0, std::uint32_t j1, const depth_plane& plane, Outside&& outside) {
  float* depths = s.image.inverse_depths + std::size_t{tile} * tile_pixels;
  std::uint32_t* ids = s.image.ids + std::size_t{tile} * tile_pixels;
  tile_state& state = s.image.states[tile];
  if (state == tile_state::empty) {
    open_tile(s.image, tile);
    state = tile_state::exact;
  }
  const floats least = all(plane.least), most = all(plane.most), step_y = all(plane.step_y);
  const ints id = all(static_cast<std::int32_t>(s.id));
  floats q = all(plane.base + plane.step_y * static_cast<float>(j0)) + all(plane.step_x) * to_floats(count_up());
  ints any = all(0);
  [[maybe_unused]] bool may_pass = false;  // known to have parts that do not fail
  for (std::uint32_t j = j0; j <= j1; ++j) {
    const ints out = outside(j);
    const floats clamped = smaller(larger(q, least), most);
    const floats old = load(depths + j * tile_size);
    if constexpr (kind == pass::see_through) {
      const std::uint32_t bits = sign_bits(without(clamped >= behind_by_reach(old), out));
      if (bits != 0) count_row(s, bits, tile_x * tile_size, tile_y * tile_size + j);
    } else {
      ints in = without(clamped > old, out);  // only the sign bits are used
      if constexpr (kind == pass::masked) {
        std::uint32_t bits = sign_bits(in);
        if (bits == 0) {
          q = q + step_y;
          continue;
        }
        const std::uint32_t x = tile_x * tile_size, y = tile_y * tile_size;
        if (!may_pass && fails_between(s, x, y + j, x + tile_size - 1, y + j1)) break;
        may_pass = true;
        bits = passing(s, bits, tile_x * tile_size, tile_y * tile_size + j);
        in = mask_of(bits);
      }
      any = any | in;
      store(depths + j * tile_size, choose(in, clamped, old));
      store(ids + j * tile_size, choose(in, id, load(ids + j * tile_size)));
    }
    q = q + step_y;
  }
  if (sign_bits(any) != 0) state = tile_state::stale;
}

// Processes a tile that the triangle covers completely.
template <pass kind>
inline void cover_all(const draw_state& s, std::uint32_t tile, std::uint32_t tile_x, std::uint32_t tile_y,
                      const depth_plane& plane) {
  if constexpr (kind == pass::opaque) {
    float* depths = s.image.inverse_depths + std::size_t{tile} * tile_pixels;
    std::uint32_t* ids = s.image.ids + std::size_t{tile} * tile_pixels;
    const floats lowest = all(plane.least), most = all(plane.most), step_y = all(plane.step_y);
    const ints id = all(static_cast<std::int32_t>(s.id));
    floats q = all(plane.base) + all(plane.step_x) * to_floats(count_up());
    floats least = most;
    if (s.image.states[tile] == tile_state::empty) {
      for (std::uint32_t j = 0; j < tile_pixels; j += tile_size) {
        const floats clamped = smaller(larger(q, lowest), most);
        store(depths + j, clamped);
        store(ids + j, id);
        least = smaller(least, clamped);
        q = q + step_y;
      }
    } else {
      for (std::uint32_t j = 0; j < tile_pixels; j += tile_size) {
        const floats clamped = smaller(larger(q, lowest), most);
        const floats old = load(depths + j);
        const ints in = clamped > old;
        const floats now = choose(in, clamped, old);
        store(depths + j, now);
        store(ids + j, choose(in, id, load(ids + j)));
        least = smaller(least, now);
        q = q + step_y;
      }
    }
    s.image.farthest[tile] = smallest_lane(least);
    s.image.states[tile] = tile_state::exact;
  } else {
    cover_rows<kind>(s, tile, tile_x, tile_y, 0, tile_size - 1, plane, [](std::uint32_t) { return all(0); });
  }
}

}  // namespace
}  // namespace sightcell::bake::cpu
