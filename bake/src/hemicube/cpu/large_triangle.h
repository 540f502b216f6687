#pragma once
// Draws triangles that reach behind the eye, out of the guard band, or over much of the image. Edges and depth plane
// are computed in double precision from homogeneous coordinates, which need no clipping. The edge through the eye-space
// corners P and Q is (P x Q) . (x, y, 1), the volume that the line of sight spans with both. The three edges are also
// the weights of the corners (Olano and Greer, "Triangle scan conversion using 2D homogeneous coordinates", 1997).
#include "hemicube/cpu/walk.h"

namespace sightcell::bake::cpu {
namespace {

// Scales a plane so that one of a and b is +-1. Then a margin can be given in pixels.
inline pixel_plane normalized(const pixel_plane& p) {
  const double a = __builtin_fabs(p.a), b = __builtin_fabs(p.b);
  const double most = a > b ? a : b;
  if (!(most > 0.0)) return {0.0, 0.0, p.c < 0.0 ? -1.0 : 1.0};
  return {p.a / most, p.b / most, p.c / most};
}

// Computes the tiles that the part in front of the near plane can touch. Returns false if the image contains no part.
inline bool tiles_of(const face_frame& face, const tile_image& image, const corner3 (&v)[3], tile_rect& rect) {
  double low_x = 1e30, low_y = 1e30, high_x = -1e30, high_y = -1e30;
  const auto add = [&](double x, double y, double z) {
    const double px = x / z * static_cast<double>(face.half) + face.center_x;
    const double py = y / z * static_cast<double>(face.half) + face.center_y;
    low_x = px < low_x ? px : low_x;
    high_x = px > high_x ? px : high_x;
    low_y = py < low_y ? py : low_y;
    high_y = py > high_y ? py : high_y;
  };
  // Well in front of the near plane, so that no drawn part is missing.
  constexpr double front = 1e-6;
  for (int k = 0; k < 3; ++k) {
    const corner3 &p = v[k], &q = v[(k + 1) % 3];
    if (p.z >= front) add(p.x, p.y, p.z);
    if ((p.z >= front) != (q.z >= front)) {
      const double t = (front - p.z) / (q.z - p.z);
      add(p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t, front);
    }
  }
  const double width = image.tiles_x * double{tile_size}, height = image.tiles_y * double{tile_size};
  if (!(low_x < width && high_x > 0.0 && low_y < height && high_y > 0.0)) return false;
  const auto tile = [](double at, double limit) {
    at = at < 0.0 ? 0.0 : at > limit - 1.0 ? limit - 1.0 : at;
    return static_cast<std::int32_t>(at) >> 3;
  };
  // One pixel more on all sides, because edges are widened.
  rect = {tile(low_x - 1.0, width), tile(low_y - 1.0, height), tile(high_x + 1.0, width), tile(high_y + 1.0, height)};
  return true;
}

// Pixels by which edges are widened, so that there is no gap to an adjacent triangle that is drawn with snapped
// corners.
constexpr double widening = 4e-5;

template <pass kind>
inline void draw_large(draw_state& s, const corner3 (&v)[3], bool both_sides) {
  const corner3 normal = cross(minus(v[1], v[0]), minus(v[2], v[0]));
  double volume = dot(normal, v[0]);
  if (volume == 0.0 || (volume < 0.0 && !both_sides)) return;
  tile_rect rect;
  if (!tiles_of(s.face, s.image, v, rect)) return;

  double nearest = 0.0, furthest = 0.0;  // of the corners' depths
  for (int k = 0; k < 3; ++k) {
    nearest = k == 0 || v[k].z < nearest ? v[k].z : nearest;
    furthest = k == 0 || v[k].z > furthest ? v[k].z : furthest;
  }
  constexpr double near = static_cast<double>(near_plane);
  const float most = static_cast<float>(1.0 / (nearest > near ? nearest : near));
  const float least = static_cast<float>(1.0 / (furthest > near ? furthest : near));
  const pixel_plane depth =
      per_pixel(s.face, {normal.x / volume, normal.y / volume, normal.z / volume});  // 1/Z along (x, y, 1)

  const double sign = volume < 0.0 ? -1.0 : 1.0;
  pixel_plane edges[3];
  for (int k = 0; k < 3; ++k) {
    const corner3 e = cross(v[k], v[(k + 1) % 3]);
    edges[k] = normalized(per_pixel(s.face, {sign * e.x, sign * e.y, sign * e.z}));
    edges[k].c += widening;
  }
  const auto at = [](const pixel_plane& p, std::int32_t tx, std::int32_t ty) {
    return static_cast<float>(p.a * (tx * 8 + 0.5) + p.b * (ty * 8 + 0.5) + p.c);
  };
  const auto plane_at = [&](std::int32_t tx, std::int32_t ty) {
    return depth_plane{at(depth, tx, ty), static_cast<float>(depth.a), static_cast<float>(depth.b), least, most};
  };
  float_edge f[3];
  for (int k = 0; k < 3; ++k)
    f[k] = {static_cast<float>(edges[k].a), static_cast<float>(edges[k].b), at(edges[k], rect.x0, rect.y0)};

  const floats lanes = to_floats(count_up());
  walk_tiles<kind>(s.image, rect, f, plane_at(rect.x0, rect.y0), [&](std::int32_t tx, std::int32_t ty, bool covered) {
    const auto x = static_cast<std::uint32_t>(tx), y = static_cast<std::uint32_t>(ty);
    const std::uint32_t tile = y * s.image.stride + x;
    if (covered) return cover_all<kind>(s, tile, x, y, plane_at(tx, ty));
    floats e0 = all(at(edges[0], tx, ty)) + all(f[0].a) * lanes, e1 = all(at(edges[1], tx, ty)) + all(f[1].a) * lanes,
           e2 = all(at(edges[2], tx, ty)) + all(f[2].a) * lanes;
    const floats b0 = all(f[0].b), b1 = all(f[1].b), b2 = all(f[2].b);
    cover_rows<kind>(s, tile, x, y, 0, tile_size - 1, plane_at(tx, ty), [&](std::uint32_t) {
      const ints out = all(0.0f) > smaller(smaller(e0, e1), e2);
      e0 = e0 + b0;
      e1 = e1 + b1;
      e2 = e2 + b2;
      return out;
    });
  });
}

}  // namespace
}  // namespace sightcell::bake::cpu
