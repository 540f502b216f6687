#pragma once
// Geometry of single triangles.
#include <array>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

using triangle = std::array<glm::vec3, 3>;

// Returns the corners of a polygon in world space, in meters.
inline triangle corners_of(const scene::world_geometry& geometry, std::uint32_t polygon) {
  const std::size_t first = 3 * std::size_t{polygon};
  return {geometry.positions[geometry.indices[first]], geometry.positions[geometry.indices[first + 1]],
          geometry.positions[geometry.indices[first + 2]]};
}

// Returns whether a point is in front of a triangle.
inline bool is_in_front(const glm::vec3& point, const triangle& t) {
  return glm::dot(glm::cross(t[1] - t[0], t[2] - t[0]), point - t[0]) > 0.0f;
}

// The largest solid angle of a triangle, in sr: half of the sphere.
inline constexpr float largest_solid_angle = 6.2831853f;

// Returns the solid angle of a triangle as seen from eye, in sr (Van Oosterom and Strackee 1983). It is exact up to
// rounding.
float solid_angle(const triangle& corners, const glm::vec3& eye);

// Returns the distance from a point to the nearest point of a triangle, in meters (Ericson, Real-Time Collision
// Detection, 5.1.5).
float distance_to_triangle(const glm::vec3& point, const triangle& corners);

// Returns whether a triangle and a box touch (separating axis test, Akenine-Moeller 2001).
bool triangle_touches_box(const triangle& corners, const glm::vec3& min, const glm::vec3& max);

// Returns a lower bound of the distance between a triangle and a box, in meters, which is the distance itself up to
// rounding in nearly all cases.
double least_distance(const triangle& corners, const glm::vec3& min, const glm::vec3& max);

}  // namespace sightcell::bake
