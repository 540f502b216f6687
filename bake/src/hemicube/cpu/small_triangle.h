#pragma once
// Draws triangles that are well in front of the eye and inside the guard band: corners snapped to 1/65536 pixel, exact
// edges in integers (64 bits at the start of each tile, 32-bit steps inside), top-left rule.
#include "hemicube/cpu/walk.h"

namespace sightcell::bake::cpu {
namespace {

// Setup of eight triangles. The origin of the fixed-point numbers is the image's lower left corner.
struct alignas(32) block_setup {
  std::int32_t x[3][8], y[3][8];
  std::int32_t px0[8], px1[8], py0[8], py1[8];  // pixels whose centers can be covered, inside the image
  float q[8], step_x[8], step_y[8], least[8], most[8];
};

struct edge {
  std::int32_t a, b;  // per pixel in x and y
  std::int64_t c;     // at the center of the first pixel of the first tile; covered where a x + b y + c >= 0
};

// The edge from p to r; the triangle is on its left. With E(x, y) in units of 2^-32 pixel^2 at pixel centers,
// E = 65536 (a x + b y) + C, so E >= 0 is a x + b y + floor(C / 65536) >= 0. A pixel center on the edge is covered only
// if it is a left or top edge.
inline edge edge_of(std::int32_t px, std::int32_t py, std::int32_t rx, std::int32_t ry, std::int32_t at_x,
                    std::int32_t at_y) {
  edge e;
  e.a = py - ry;
  e.b = rx - px;
  const bool keeps = e.a > 0 || (e.a == 0 && e.b < 0);
  const std::int64_t full = std::int64_t{e.a} * (at_x - px) + std::int64_t{e.b} * (at_y - py);
  e.c = (full - (keeps ? 0 : 1)) >> 16;
  return e;
}

inline std::int32_t clamped(std::int64_t c) {
  // Inside a tile an edge changes by less than 14 * 2^25; beyond that only the sign matters.
  constexpr std::int64_t limit = 1 << 30;
  return static_cast<std::int32_t>(c < -limit ? -limit : c > limit ? limit : c);
}

template <pass kind>
inline void draw_small(draw_state& s, const block_setup& b, std::uint32_t k) {
  const std::int32_t tx0 = b.px0[k] >> 3, tx1 = b.px1[k] >> 3, ty0 = b.py0[k] >> 3, ty1 = b.py1[k] >> 3;
  const auto first_tile = static_cast<std::uint32_t>(ty0) * s.image.stride + static_cast<std::uint32_t>(tx0);
  const bool one_tile = tx0 == tx1 && ty0 == ty1;
  const auto occluded = [&](std::uint32_t tile) {
    return kind != pass::see_through && b.most[k] <= s.image.farthest[tile];
  };
  if (one_tile && occluded(first_tile)) return;
  const std::int32_t at_x = tx0 * 8 * sub_pixel + sub_pixel / 2, at_y = ty0 * 8 * sub_pixel + sub_pixel / 2;
  const edge e[3] = {edge_of(b.x[0][k], b.y[0][k], b.x[1][k], b.y[1][k], at_x, at_y),
                     edge_of(b.x[1][k], b.y[1][k], b.x[2][k], b.y[2][k], at_x, at_y),
                     edge_of(b.x[2][k], b.y[2][k], b.x[0][k], b.y[0][k], at_x, at_y)};
  constexpr float per_unit = 1.0f / sub_pixel;
  const depth_plane plane{b.q[k] + b.step_x[k] * (static_cast<float>(at_x - b.x[0][k]) * per_unit) +
                              b.step_y[k] * (static_cast<float>(at_y - b.y[0][k]) * per_unit),
                          b.step_x[k], b.step_y[k], b.least[k], b.most[k]};
  const ints lanes = count_up();
  const ints a0 = all(e[0].a) * lanes, a1 = all(e[1].a) * lanes, a2 = all(e[2].a) * lanes;
  const ints b0 = all(e[0].b), b1 = all(e[1].b), b2 = all(e[2].b);
  // Inlined at all three calls, because a function would read the captured values from memory.
  const auto cover = [&](std::int32_t tx, std::int32_t ty) __attribute__((always_inline)) {
    const std::int32_t dx = (tx - tx0) * 8, dy = (ty - ty0) * 8;
    const std::uint32_t j0 = ty == ty0 ? static_cast<std::uint32_t>(b.py0[k] & 7) : 0;
    const std::uint32_t j1 = ty == ty1 ? static_cast<std::uint32_t>(b.py1[k] & 7) : 7;
    const auto start = [&](const edge& of) {
      return all(clamped(of.c + std::int64_t{of.a} * dx + std::int64_t{of.b} * dy) +
                 of.b * static_cast<std::int32_t>(j0));
    };
    ints e0 = start(e[0]) + a0, e1 = start(e[1]) + a1, e2 = start(e[2]) + a2;
    const depth_plane here{plane.base + plane.step_x * static_cast<float>(dx) + plane.step_y * static_cast<float>(dy),
                           plane.step_x, plane.step_y, plane.least, plane.most};
    cover_rows<kind>(s, static_cast<std::uint32_t>(ty) * s.image.stride + static_cast<std::uint32_t>(tx),
                     static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty), j0, j1, here, [&](std::uint32_t) {
                       const ints out = e0 | e1 | e2;
                       e0 = e0 + b0;
                       e1 = e1 + b1;
                       e2 = e2 + b2;
                       return out;
                     });
  };
  if (one_tile) return cover(tx0, ty0);
  if (tx1 - tx0 <= 1 && ty1 - ty0 <= 1) {
    for (std::int32_t ty = ty0; ty <= ty1; ++ty)
      for (std::int32_t tx = tx0; tx <= tx1; ++tx)
        if (!occluded(static_cast<std::uint32_t>(ty) * s.image.stride + static_cast<std::uint32_t>(tx))) cover(tx, ty);
    return;
  }
  float_edge f[3];
  for (int i = 0; i < 3; ++i)
    f[i] = {static_cast<float>(e[i].a), static_cast<float>(e[i].b), static_cast<float>(e[i].c)};
  walk_tiles<kind>(s.image, {tx0, ty0, tx1, ty1}, f, plane, [&](std::int32_t tx, std::int32_t ty, bool covered) {
    if (!covered) return cover(tx, ty);
    const depth_plane here{plane.base + plane.step_x * static_cast<float>((tx - tx0) * 8) +
                               plane.step_y * static_cast<float>((ty - ty0) * 8),
                           plane.step_x, plane.step_y, plane.least, plane.most};
    cover_all<kind>(s, static_cast<std::uint32_t>(ty) * s.image.stride + static_cast<std::uint32_t>(tx),
                    static_cast<std::uint32_t>(tx), static_cast<std::uint32_t>(ty), here);
  });
}

}  // namespace
}  // namespace sightcell::bake::cpu
