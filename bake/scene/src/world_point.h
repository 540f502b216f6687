#pragma once
// Transforms points into world space: in double precision, rounded once. All code that flattens uses it, so results
// are equal bit for bit. Also tests whether numbers are finite.
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sightcell::scene {

// Returns the point in world space.
inline glm::vec3 world_point(const glm::dmat4& to_world, const glm::vec3& local) {
  const glm::dvec3 p(local);
  return glm::vec3(to_world[0] * p.x + to_world[1] * p.y + to_world[2] * p.z + to_world[3]);
}

inline bool is_finite(const glm::vec3& p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

inline bool is_finite(const glm::vec2& p) {
  return std::isfinite(p.x) && std::isfinite(p.y);
}

inline bool is_finite(const glm::dmat4& m) {
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(m[i / 4][i % 4])) return false;
  return true;
}

// Returns whether a transform mirrors. Polygons of such a draw have two corners swapped, so that front faces stay
// counter-clockwise.
inline bool is_mirrored(const glm::dmat4& to_world) {
  return glm::determinant(glm::dmat3(to_world)) < 0.0;
}

}  // namespace sightcell::scene
