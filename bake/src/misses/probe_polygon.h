#pragma once
// Is one polygon seen from one eye? For who was told that it is.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>

#include "trace/ray_scene.h"

namespace sightcell::bake {

struct polygon_sight {
  bool seen = false;       // by a ray, under all rules of seeing
  bool counts = false;     // and of all that lies in the same place there the set has nothing (rule 2)
  std::uint64_t rays = 0;  // that were cast
};

// Casts rays at places spread over the polygon as the eye sees it, always into the largest part that none has gone to,
// until one of them counts, no part is larger than a pixel of a picture, or 2^18 are cast. contains: is a polygon in
// the set? Depends on the arguments alone; may be called from any thread.
polygon_sight probe_polygon(const ray_scene& rays, float smallest_gap, const glm::vec3& eye, std::uint32_t polygon,
                            const std::function<bool(std::uint32_t)>& contains);

}  // namespace sightcell::bake
