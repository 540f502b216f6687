#pragma once
// What the rays of a sampler find: noted in parallel, then tested by the rules of seeing and joined in an order that
// depends on places alone.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "bound/verification_rays.h"
#include "cell_set/cell_set.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// A ray that met a polygon which is not in the set.
struct ray_find {
  std::uint32_t polygon = no_polygon;
  glm::vec3 eye{0.0f}, direction{0.0f};
  float distance = 0.0f;
  bool eye_is_free = false;  // else that is asked before anything joins
};

// A polygon that joined: where on it and from where it was seen. What guided samplers go on from.
struct seed_ray {
  std::uint32_t polygon = no_polygon;
  glm::vec3 eye{0.0f}, point{0.0f};
};

// One thread's. The set must not change while rays are cast.
class noting_rays {
 public:
  noting_rays(const ray_scene& rays, const cell_set& set) : rays_(rays), set_(set) {}

  // Adds to found all that the ray sees and the set does not have. The answer is valid until the next call.
  const sight& cast(const glm::vec3& eye, const glm::vec3& direction, bool eye_is_free, std::vector<ray_find>& found);

 private:
  const ray_scene& rays_;
  const cell_set& set_;
  sight seen_;
};

// Adds to set what was found from a free eye and not through a crack (rule 3), with what lies in the same place (rule
// 2). Returns what is new, one lead per polygon (of exact duplicates one of them), in an order that neither ids nor the
// order of found decide. found is reordered. Tests run on the calling thread's TBB arena.
std::vector<seed_ray> join_finds(const ray_scene& rays, const visibility_rules& rules, std::vector<ray_find>& found,
                                 cell_set& set);

}  // namespace sightcell::bake
