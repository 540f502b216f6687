#pragma once
// Corners in eye space, and linear functions of the pixel.
#include "hemicube/cpu/kernel.h"

namespace sightcell::bake::cpu {
namespace {

struct corner3 {
  double x, y, z;
};

inline corner3 cross(const corner3& p, const corner3& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}
inline double dot(const corner3& p, const corner3& q) {
  return p.x * q.x + p.y * q.y + p.z * q.z;
}
inline corner3 minus(const corner3& p, const corner3& q) {
  return {p.x - q.x, p.y - q.y, p.z - q.z};
}

// A linear function of the pixel: a px + b py + c, from the image's lower left corner on.
struct pixel_plane {
  double a, b, c;
};

// Converts f . (x, y, 1) on the image plane at distance 1 to a function of pixels.
inline pixel_plane per_pixel(const face_frame& face, const corner3& f) {
  const double half = static_cast<double>(face.half);
  const pixel_plane p{f.x / half, f.y / half, 0.0};
  return {p.a, p.b, f.z - p.a * face.center_x - p.b * face.center_y};
}

}  // namespace
}  // namespace sightcell::bake::cpu
