#pragma once
// Tests whether a polygon is visible from an eye, to confirm reported misses.
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>

#include "trace/ray_scene.h"

namespace sightcell::bake {

// The result of a test.
struct polygon_sight {
  bool seen = false;       // a ray hit it, under all visibility rules
  bool counts = false;     // and the set contains none of the polygons that coincide with it there (rule 2)
  std::uint64_t rays = 0;  // cast
};

// Casts rays at points spread over the polygon as seen from the eye, always into the largest part that no ray was
// aimed at, until a ray counts, no part is larger than a pixel of a picture, or 2^18 rays are cast. The result
// depends on the arguments alone. May be called from any thread.
// contains: returns whether a polygon is in the set.
polygon_sight probe_polygon(const ray_scene& rays, float smallest_gap, const glm::vec3& eye, std::uint32_t polygon,
                            const std::function<bool(std::uint32_t)>& contains);

}  // namespace sightcell::bake
