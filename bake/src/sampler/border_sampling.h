#pragma once
// Adaptive border sampling (Wonka et al., Guided Visibility Sampling, SIGGRAPH 2006): around a polygon
// that was just found lies what is found next, so rays go closely past its border.
#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>

#include "trace/triangle_math.h"

namespace sightcell::bake {

// A triangle enlarged to nine corners: of each corner three points in turn, moved outward across the edge that ends
// there, along the bisector, and across the edge that begins there.
using border_polygon = std::array<glm::vec3, 9>;

// offset: how far outward, as a share of the corner's distance from the eye. Points are moved at right angles to the
// plane through the eye and the edge, which needs no projection: a polygon may reach behind the eye. Which corner comes
// first does not depend on the triangle's own order.
border_polygon enlarged(const triangle& corners, const glm::vec3& eye, float offset);

// What a ray toward a point of the border met.
struct border_hit {
  glm::vec3 point{0.0f};
  std::uint32_t front = 0;
  float distance = 0.0f;
};

// A ray from the eye toward a point.
using border_cast = std::function<border_hit(const glm::vec3& point)>;

// Casts rays to the nine corners, and wherever two neighbors met different polygons to the middle between them, up to
// depth times.
void sample_border(const border_polygon& border, std::uint32_t depth, const border_cast& cast);

// No call of sample_border casts more.
std::uint64_t most_border_rays(std::uint32_t depth);

}  // namespace sightcell::bake
