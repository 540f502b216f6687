#pragma once
// The finds of a sampler's rays. They are recorded in parallel, then tested by the visibility rules and added in an
// order that depends on positions alone.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "bound/verification_rays.h"
#include "cell_set/cell_set.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// A ray that hit a polygon which is not in the set.
struct ray_find {
  std::uint32_t polygon = no_polygon;
  glm::vec3 eye{0.0f}, direction{0.0f};
  float distance = 0.0f;
  bool eye_is_free = false;  // false: the eye is tested before the polygon joins
};

// A polygon that joined, with the point on it and the viewpoint from where it was found. Guided samplers derive
// further rays from it.
struct seed_ray {
  std::uint32_t polygon = no_polygon;
  glm::vec3 eye{0.0f}, point{0.0f};
};

// Used by one thread. The set must not change while rays are cast.
class noting_rays {
 public:
  noting_rays(const ray_scene& rays, const cell_set& set) : rays_(rays), set_(set) {}

  // Casts a ray and appends all visible polygons that the set lacks to found. The result is valid until the next
  // call.
  const sight& cast(const glm::vec3& eye, const glm::vec3& direction, bool eye_is_free, std::vector<ray_find>& found);

 private:
  const ray_scene& rays_;
  const cell_set& set_;
  sight seen_;
};

// Adds to the set the polygons that were found from a valid viewpoint and not through a light leak (rule 3), with the
// polygons that coincide with them (rule 2). Returns one seed ray per new polygon (one for a class of exact
// duplicates), in an order that depends neither on ids nor on the order of found. found is reordered. Tests run on
// the calling thread's TBB arena.
std::vector<seed_ray> join_finds(const ray_scene& rays, const visibility_rules& rules, std::vector<ray_find>& found,
                                 cell_set& set);

}  // namespace sightcell::bake
