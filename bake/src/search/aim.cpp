#include "search/aim.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>

namespace sightcell::bake {

glm::vec3 random_point(const triangle& t, random_stream& random) {
  const float root = std::sqrt(random.uniform()), v = random.uniform();
  return t[0] * (1.0f - root) + t[1] * (root * (1.0f - v)) + t[2] * (root * v);
}

std::uint64_t name_of(const triangle& t) {
  std::uint64_t name = 0;
  for (const glm::vec3& corner : t) {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis)
      h = (h ^ std::bit_cast<std::uint32_t>(corner[axis] + 0.0f)) * 0x9E3779B97F4A7C15u;
    name += h ^ (h >> 32);  // a sum does not depend on which corner comes first
  }
  return name;
}

bool aimed_rays::aim(const glm::vec3& eye, const glm::vec3& point, std::uint32_t target,
                     std::vector<found_polygon>& found) {
  const glm::vec3 toward = point - eye;
  const float length = glm::length(toward);
  if (!(length > 0.0f)) return false;
  const glm::vec3 direction = toward / length;
  rays_.trace(eye, direction, seen_);
  return take({eye, direction}, seen_, length, target, found);
}

bool aimed_rays::take(const sight_line& line, const sight& seen, float length, std::uint32_t target,
                      std::vector<found_polygon>& found) {
  bool hit = seen.front == target;
  add_new(seen.front, line.eye, line.direction, seen.distance, found);
  for (const passed_polygon& p : seen.before) {
    add_new(p.polygon, line.eye, line.direction, p.distance, found);
    hit = hit || p.polygon == target;
  }
  // Rule 2: the target may coincide with the polygon that was hit at its distance.
  if (hit || !(std::abs(seen.distance - length) <= coincidence_reach(seen.distance))) return hit;
  rays_.coincident(line.eye, line.direction, seen.distance, coincident_);
  for (const std::uint32_t polygon : coincident_) {
    add_new(polygon, line.eye, line.direction, seen.distance, found);
    hit = hit || polygon == target;
  }
  return hit;
}

void aimed_rays::add_new(std::uint32_t polygon, const glm::vec3& eye, const glm::vec3& direction, float distance,
                         std::vector<found_polygon>& found) const {
  if (polygon == no_polygon || set_.contains(polygon)) return;
  if (rays_.through_gap(eye, direction, distance, smallest_gap_)) return;
  found.push_back({polygon, eye});
}

}  // namespace sightcell::bake
