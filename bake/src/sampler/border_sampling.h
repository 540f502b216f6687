#pragma once
// Adaptive border sampling (Wonka et al., Guided Visibility Sampling, SIGGRAPH 2006): casts rays closely past the
// border of a polygon that was just found, because its neighbors are probably visible.
#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>

#include "trace/triangle_math.h"

namespace sightcell::bake {

// A triangle enlarged to nine points, three per corner in order: moved outward across the edge that ends at the
// corner, along the bisector, and across the edge that begins there.
using border_polygon = std::array<glm::vec3, 9>;

// Returns the enlarged triangle. Points are moved at right angles to the plane through the eye and the edge. This
// needs no projection, so a polygon may reach behind the eye. Which corner comes first does not depend on the
// triangle's own order.
// offset: distance outward as a share of the corner's distance from the eye.
border_polygon enlarged(const triangle& corners, const glm::vec3& eye, float offset);

// The result of a ray toward a point of the border.
struct border_hit {
  glm::vec3 point{0.0f};
  std::uint32_t front = 0;
  float distance = 0.0f;
};

// Casts a ray from the eye toward a point.
using border_cast = std::function<border_hit(const glm::vec3& point)>;

// Casts rays to the nine points. Where two consecutive rays hit different polygons, casts one to the middle between
// them, recursively up to depth levels.
void sample_border(const border_polygon& border, std::uint32_t depth, const border_cast& cast);

// Returns the largest number of rays that a call of sample_border casts.
std::uint64_t most_border_rays(std::uint32_t depth);

}  // namespace sightcell::bake
