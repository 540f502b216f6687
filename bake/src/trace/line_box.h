#pragma once
// Clips a line to a box.
#include <algorithm>
#include <glm/vec3.hpp>

namespace sightcell::bake {

// Clips the interval from .. to of a line to the part inside a box (slab method, Kay and Kajiya 1986).
// min, max: the box, borders included.
// start, direction: the line. from and to are parameters along direction.
// Returns false if not even a point is left. from and to are then undefined.
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
