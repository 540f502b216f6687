#pragma once
// Finds the tiles of a rectangle that a triangle can change, eight at a time: tiles inside all edges where the triangle
// is not behind all pixels.
#include "hemicube/cpu/pixels.h"

namespace sightcell::bake::cpu {
namespace {

// a x + b y + c per pixel, x = y = 0 at the center of the first pixel of the first tile; not negative where covered.
// Rounded, so it serves to classify tiles only, with a margin of a thousandth of a pixel.
struct float_edge {
  float a, b, c;
};

// Calls draw(tile_x, tile_y, covered) for these tiles, row by row. covered: the triangle certainly covers the whole
// tile. plane.base is the value in the first tile of the rectangle.
template <pass kind, class Draw>
inline void walk_tiles(const tile_image& image, const tile_rect& rect, const float_edge (&edges)[3],
                       const depth_plane& plane, const Draw& draw) {
  constexpr float last = tile_size - 1;
  float highest[3], range[3], margin[3];
  for (int k = 0; k < 3; ++k) {
    const float_edge& e = edges[k];
    margin[k] = 1e-3f * (__builtin_fabsf(e.a) + __builtin_fabsf(e.b));
    highest[k] = e.c + (e.a > 0.0f ? last * e.a : 0.0f) + (e.b > 0.0f ? last * e.b : 0.0f);
    range[k] = last * (__builtin_fabsf(e.a) + __builtin_fabsf(e.b));
  }
  const float nearest = plane.base + (plane.step_x > 0.0f ? last * plane.step_x : 0.0f) +
                        (plane.step_y > 0.0f ? last * plane.step_y : 0.0f);
  // Bound of the rounding error of the plane far from the first tile.
  const float slack = 1e-6f * __builtin_fabsf(plane.base);
  const floats lanes = to_floats(count_up()) * all(static_cast<float>(tile_size));
  for (std::int32_t ty = rect.y0; ty <= rect.y1; ++ty) {
    const auto dy = static_cast<float>((ty - rect.y0) * 8);
    for (std::int32_t tx = rect.x0 & ~7; tx <= rect.x1; tx += 8) {
      const floats dx = lanes + all(static_cast<float>((tx - rect.x0) * 8));
      ints out = all(0), all_in = all(-1);
      for (int k = 0; k < 3; ++k) {
        const floats most = all(highest[k] + edges[k].b * dy) + all(edges[k].a) * dx;
        out = out | (all(-margin[k]) > most);
        all_in = all_in & (most > all(range[k] + margin[k]));
      }
      const std::uint32_t row = static_cast<std::uint32_t>(ty) * image.stride + static_cast<std::uint32_t>(tx);
      if constexpr (kind != pass::see_through) {
        const floats near_q = smaller(all(nearest + plane.step_y * dy) + all(plane.step_x) * dx, all(plane.most));
        out = out | (load(image.farthest + row) >= larger(near_q, all(plane.least)) * all(1.00001f) + all(slack));
      }
      std::uint32_t live = ~sign_bits(out) & 0xFFu;
      if (tx < rect.x0) live &= 0xFFu << (rect.x0 - tx);
      if (tx + 7 > rect.x1) live &= 0xFFu >> (tx + 7 - rect.x1);
      const std::uint32_t covered = sign_bits(all_in);
      for (; live != 0; live &= live - 1) {
        const auto k = static_cast<std::uint32_t>(__builtin_ctz(live));
        draw(tx + static_cast<std::int32_t>(k), ty, (covered >> k & 1u) != 0);
      }
    }
  }
}

}  // namespace
}  // namespace sightcell::bake::cpu
