#include "trace/light_reach.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightcell::bake {
namespace {

// A point as the cone sees it: meters along the axis, and from it.
struct cone_place {
  double along = 0.0, across = 0.0;
};

cone_place place_in_cone(const scene::light& light, const glm::dvec3& point) {
  const glm::dvec3 to_point = point - glm::dvec3(position_of(light));
  const glm::dvec3 axis = glm::normalize(glm::dvec3(light.direction[0], light.direction[1], light.direction[2]));
  const double along = glm::dot(to_point, axis);
  return {along, glm::length(to_point - along * axis)};
}

}  // namespace

bool is_in_reach(const scene::light& light, const glm::vec3& point) {
  if (!(glm::distance(position_of(light), point) <= light.range)) return false;
  if (light.cone == 0.0f) return true;
  const cone_place at = place_in_cone(light, point);
  const double angle = static_cast<double>(light.cone);
  return at.across * std::cos(angle) <= at.along * std::sin(angle);
}

bool may_reach(const scene::light& light, const triangle& corners, float slack) {
  if (distance_to_triangle(position_of(light), corners) > light.range + slack) return false;
  if (light.cone == 0.0f) return true;
  // The sphere around the triangle. A plane along the side of the cone, through its tip, is at most as far from the
  // center as the cone is.
  const glm::dvec3 center = (glm::dvec3(corners[0]) + glm::dvec3(corners[1]) + glm::dvec3(corners[2])) / 3.0;
  double radius = 0.0;
  for (const glm::vec3& corner : corners) radius = std::max(radius, glm::distance(center, glm::dvec3(corner)));
  const cone_place at = place_in_cone(light, center);
  const double angle = static_cast<double>(light.cone);
  const double outside = at.across * std::cos(angle) - at.along * std::sin(angle);
  return outside <= radius + static_cast<double>(slack);
}

}  // namespace sightcell::bake
