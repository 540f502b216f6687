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

struct draw_state {
  const face_frame& face;
  const tile_image& image;
  const polygon_counter& counter;
  const scene_view& scene;
  std::uint32_t id = 0;                  // of the current triangle
  std::uint32_t masked = nothing;        // index of the triangle in world_geometry::masked
  alignas(32) float corners[3][3][8]{};  // x, y, z in eye space of the corners of a block with masked triangles
  std::uint32_t lane = 0;                // of the current triangle
  bool has_planes = false;
  alpha_planes planes{};
};

// Returns the planes of the current triangle, which is masked. Many triangles are occluded and need none.
inline const alpha_planes& planes_of(draw_state& s) {
  if (s.has_planes) return s.planes;
  s.has_planes = true;
  const auto value = [&](int corner, int axis) { return static_cast<double>(s.corners[corner][axis][s.lane]); };
  const auto corner = [&](int c) -> corner3 { return {value(c, 0), value(c, 1), value(c, 2)}; };
  const masked_triangle& t = s.scene.masked_triangles[s.masked];
  return s.planes = planes_of(s.face, t, s.scene.tests[t.test].varies, {corner(0), corner(1), corner(2)});
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

inline void count_row(draw_state& s, std::uint32_t bits, std::uint32_t x, std::uint32_t y) {
  if (y >= s.face.height || x >= s.face.width) return;
  if (x + tile_size > s.face.width) bits &= 0xFFu >> (x + tile_size - s.face.width);
  if (bits != 0 && s.masked != nothing) {
    const alpha_test& test = s.scene.tests[s.scene.masked_triangles[s.masked].test];
    bits &= alpha_passes(s.scene, test, tile_of(planes_of(s), x, y), to_floats(count_up()), all(0.0f));
  }
  if (bits == 0) return;
  count(s.counter, s.id, static_cast<std::uint32_t>(__builtin_popcount(bits)),
        atlas_pixel(s.face, x + static_cast<std::uint32_t>(__builtin_ctz(bits)), y));
}

// Returns those pixels of a tile, which the current masked triangle covers, whose alpha passes. x, y: its first pixel.
inline tile_bits passing(draw_state& s, tile_bits bits, std::uint32_t x, std::uint32_t y) {
  constexpr int most_tested = 16;  // two tests of eight pixels cost as much as a question to the tables
  const masked_triangle& triangle = s.scene.masked_triangles[s.masked];
  const alpha_planes& planes = planes_of(s);
  if (__builtin_popcountll(bits) > most_tested) {
    const auto first = static_cast<std::uint32_t>(__builtin_ctzll(bits)) / tile_size,
               last = static_cast<std::uint32_t>(63 - __builtin_clzll(bits)) / tile_size;
    const alpha_result known = known_between(s.scene, triangle, planes, x, y + first, x + tile_size - 1, y + last);
    if (known == alpha_result::fails) return 0;
    if (known == alpha_result::passes) return bits;
  }
  return alpha_passes(s.scene, s.scene.tests[triangle.test], tile_of(planes, x, y), bits);
}

// Processes rows j0 to j1 of a tile. The sign bits of outside(j) mark the pixels that the triangle does not cover.
template <pass kind, class Outside>
inline void cover_rows(draw_state& s, std::uint32_t tile, std::uint32_t tile_x, std::uint32_t tile_y, std::uint32_t j0,
                       std::uint32_t j1, const depth_plane& plane, Outside&& outside) {
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
  const auto write = [&](std::uint32_t j, const ints& in, const floats& now, const floats& old) {
    store(depths + j * tile_size, choose(in, now, old));
    store(ids + j * tile_size, choose(in, id, load(ids + j * tile_size)));
  };
  ints any = all(0);
  tile_bits front = 0;                          // of a masked triangle
  alignas(32) float clamped_rows[tile_pixels];  // likewise
  for (std::uint32_t j = j0; j <= j1; ++j) {
    const ints out = outside(j);
    const floats clamped = smaller(larger(q, least), most);
    const floats old = load(depths + j * tile_size);
    if constexpr (kind == pass::see_through) {
      const std::uint32_t bits = sign_bits(without(clamped >= behind_by_reach(old), out));
      if (bits != 0) count_row(s, bits, tile_x * tile_size, tile_y * tile_size + j);
    } else if constexpr (kind == pass::masked) {
      // Without a branch: whether a row has a pixel in front is as good as random.
      store(clamped_rows + j * tile_size, clamped);
      front |= tile_bits{sign_bits(without(clamped > old, out))} << (tile_size * j);
    } else {
      const ints in = without(clamped > old, out);  // only the sign bits are used
      any = any | in;
      write(j, in, clamped, old);
    }
    q = q + step_y;
  }
  if constexpr (kind == pass::masked) {
    if (front == 0) return;
    front = passing(s, front, tile_x * tile_size, tile_y * tile_size);
    if (front == 0) return;
    state = tile_state::stale;
    for (std::uint32_t j = j0; j <= j1; ++j)
      if (const std::uint32_t bits = row_of(front, j))
        write(j, mask_of(bits), load(clamped_rows + j * tile_size), load(depths + j * tile_size));
  } else if (sign_bits(any) != 0) {
    state = tile_state::stale;
  }
}

// Processes a tile that the triangle covers completely.
template <pass kind>
inline void cover_all(draw_state& s, std::uint32_t tile, std::uint32_t tile_x, std::uint32_t tile_y,
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
