#include "trace/viewpoints.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "trace/triangle_math.h"

namespace sightcell::bake {

std::vector<glm::vec3> draw_viewpoints(const ray_scene& rays, const viewpoint_region& where, float radius,
                                       std::size_t wanted, std::uint64_t max_tries, random_stream& random,
                                       std::uint64_t& tries) {
  constexpr std::size_t group = 64;
  std::vector<glm::vec3> found, candidates;
  std::vector<std::uint8_t> free;
  std::uint64_t tested = 0;
  while (found.size() < wanted && tested < max_tries) {
    const std::size_t count = std::min<std::uint64_t>({group, max_tries - tested, 2 * (wanted - found.size()) + 6});
    candidates.clear();
    for (std::size_t i = 0; i < count; ++i) candidates.push_back(where.draw(random));
    free.assign(count, 0);
    rays.find_valid(candidates, radius, free);
    for (std::size_t i = 0; i < count && found.size() < wanted; ++i)
      if (free[i]) found.push_back(candidates[i]);
    tested += count;
  }
  tries += tested;
  return found;
}

bool faces(const ray_scene& rays, std::uint32_t polygon, const glm::vec3& eye) {
  return rays.sees_both_sides(polygon) || is_in_front(eye, corners_of(rays.geometry(), polygon));
}

}  // namespace sightcell::bake
