#pragma once
// What a box leaves of a line.
#include <algorithm>
#include <glm/vec3.hpp>

namespace sightcell::bake {

// Cuts from..to, places on the line counted in lengths of direction, down to what lies in the box (slabs, Kay and
// Kajiya 1986); false where nothing is left, not even a point. Then from and to say nothing.
inline bool clip_line(const glm::vec3& min, const glm::vec3& max, const glm::vec3& start, const glm::vec3& direction,
                      float& from, float& to) {
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0.0f) {
      if (start[axis] < min[axis] || start[axis] > max[axis]) return false;
      continue;
    }
    const float a = (min[axis] - start[axis]) / direction[axis], b = (max[axis] - start[axis]) / direction[axis];
    from = std::max(from, std::min(a, b));
    to = std::min(to, std::max(a, b));
  }
  return from <= to;
}

}  // namespace sightcell::bake
