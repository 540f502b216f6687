#include "seeing/gap_filter.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

#include "rays/triangle_math.h"
#include "source/hemicube_faces.h"

namespace sightcell::bake {
namespace {

// Where a line meets the plane of a triangle: the distance along it. A pixel's center lies on the triangle but for
// rounding, so the plane is enough. Not finite or not positive where the plane is seen edge-on.
float distance_to_plane(const triangle& t, const glm::vec3& eye, const glm::vec3& direction) {
  const glm::dvec3 a(t[0]);
  const glm::dvec3 normal = glm::cross(glm::dvec3(t[1]) - a, glm::dvec3(t[2]) - a);
  return static_cast<float>(glm::dot(normal, a - glm::dvec3(eye)) / glm::dot(normal, glm::dvec3(direction)));
}

}  // namespace

void gap_filter::render(std::span<const pose> poses, std::span<hemicube_view> views) {
  behind_.render(poses, views);
  if (!(smallest_gap_ > 0.0f)) return;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::erase_if(views[i].seen, [&](const seen_polygon& seen) {
      return seen.pixels <= 4 * resolution() && !set_.contains(seen.id) && through_gap(poses[i], seen);
    });
  }
}

bool gap_filter::through_gap(const pose& where, const seen_polygon& seen) const {
  const glm::vec3 direction = pixel_direction(where, resolution(), seen.pixel);
  const float distance = distance_to_plane(corners_of(rays_.geometry(), seen.id), where.eye, direction);
  return std::isfinite(distance) && distance > 0.0f && rays_.through_gap(where.eye, direction, distance, smallest_gap_);
}

}  // namespace sightcell::bake
