#pragma once
// An order of points by coordinates, so that results do not depend on polygon ids.
#include <glm/vec3.hpp>
#include <tuple>
#include <vector>

namespace sightcell::bake {

inline bool is_lower(const glm::vec3& a, const glm::vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// Sorts points and leaves each in once. Takes little time for sorted points with few others at their end.
void sort_unique(std::vector<glm::vec3>& points);

}  // namespace sightcell::bake
