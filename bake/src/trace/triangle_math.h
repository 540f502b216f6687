#pragma once
// Small exact questions about one triangle.
#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

using triangle = std::array<glm::vec3, 3>;

inline triangle corners_of(const scene::world_geometry& geometry, std::uint32_t polygon) {
  const std::size_t first = 3 * std::size_t{polygon};
  return {geometry.positions[geometry.indices[first]], geometry.positions[geometry.indices[first + 1]],
          geometry.positions[geometry.indices[first + 2]]};
}

// sr, half of all directions: no triangle covers more.
inline constexpr float largest_solid_angle = 6.2831853f;

// How much of all directions the triangle covers, seen from eye, sr; exact (Van Oosterom and Strackee 1983).
float solid_angle(const triangle& corners, const glm::vec3& eye);

// Distance in metres from a point to the nearest point of the triangle (Ericson, Real-Time Collision Detection, 5.1.5).
float distance_to_triangle(const glm::vec3& point, const triangle& corners);

// Do triangle and box touch? Separating axes (Akenine-Moeller 2001).
bool triangle_touches_box(const triangle& corners, const glm::vec3& min, const glm::vec3& max);

}  // namespace sightcell::bake
