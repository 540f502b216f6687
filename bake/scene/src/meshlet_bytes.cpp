#include "meshlet_bytes.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace sightcell::scene {
namespace {

struct meshlet_bounds {
  float center[3] = {0.0f, 0.0f, 0.0f};
  float radius = std::numeric_limits<float>::max();  // of what may be anywhere
  float cone_apex[3] = {0.0f, 0.0f, 0.0f};
  float cone_axis[3] = {0.0f, 0.0f, 0.0f};
  float cone_cutoff = 1.0f;  // no cone
};

bool all_finite(const geometry& g, std::span<const std::uint32_t> corners) {
  return std::all_of(corners.begin(), corners.end(), [&](std::uint32_t corner) {
    const glm::vec3& p = g.positions[corner];
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  });
}

// Grows the radius by the rounding of float, so that the sphere contains each corner in exact arithmetic.
float grown_radius(const geometry& g, std::span<const std::uint32_t> corners, const float (&center)[3]) {
  double most = 0.0;
  for (const std::uint32_t corner : corners) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) {
      const double d = double{g.positions[corner][k]} - double{center[k]};
      sum += d * d;
    }
    most = std::max(most, sum);
  }
  const auto radius = static_cast<float>(std::sqrt(most));
  return std::nextafter(radius, std::numeric_limits<float>::infinity());
}

meshlet_bounds bounds_of(const geometry& g, std::span<const std::uint32_t> corners, bool has_cone) {
  meshlet_bounds out;
  if (!all_finite(g, corners)) return out;
  const meshopt_Bounds made = meshopt_computeClusterBounds(corners.data(), corners.size(), &g.positions[0].x,
                                                           g.positions.size(), sizeof g.positions[0]);
  if (made.radius == 0.0f) {  // triangles without an area, of which meshoptimizer has no sphere
    const glm::vec3& p = g.positions[corners[0]];
    for (int k = 0; k < 3; ++k) out.center[k] = p[k];
  } else {
    std::copy_n(made.center, 3, out.center);
    if (has_cone) {
      std::copy_n(made.cone_apex, 3, out.cone_apex);
      std::copy_n(made.cone_axis, 3, out.cone_axis);
      out.cone_cutoff = made.cone_cutoff;
    }
  }
  out.radius = grown_radius(g, corners, out.center);
  return out;
}

}  // namespace

void put_meshlet(byte_writer& out, const meshlet_place& place, const geometry& g,
                 std::span<const std::uint32_t> corners, bool bounded, bool has_cone) {
  const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
  const meshlet_bounds bounds = bounded ? bounds_of(g, corners, has_cone) : meshlet_bounds{};
  out.put(place.group);
  out.put(place.first_index);
  out.put(static_cast<std::uint32_t>(corners.size() / 3));
  out.put(*least);
  out.put(*most - *least + 1);
  out.put(bounds.center);
  out.put(bounds.radius);
  out.put(bounds.cone_apex);
  out.put(bounds.cone_axis);
  out.put(bounds.cone_cutoff);
}

}  // namespace sightcell::scene
