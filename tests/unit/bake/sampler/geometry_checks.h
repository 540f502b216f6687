#pragma once
// Whether points and rays lie where they should.
#include <glm/geometric.hpp>

#include "sightcell/base/box.h"
#include "trace/triangle_math.h"

namespace sightcell::test {

inline bool inside(const glm::vec3& p, const bake::box& where) {
  return glm::all(glm::greaterThanEqual(p, where.min)) && glm::all(glm::lessThanEqual(p, where.max));
}

// At any distance, and through the back too.
inline bool ray_meets(const bake::triangle& t, const glm::vec3& eye, const glm::vec3& toward) {
  const glm::dvec3 d(toward - eye), a(t[0]), b(t[1]), c(t[2]), o(eye);
  const double u = glm::dot(d, glm::cross(a - o, b - o)), v = glm::dot(d, glm::cross(b - o, c - o)),
               w = glm::dot(d, glm::cross(c - o, a - o));
  return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
}

}  // namespace sightcell::test
