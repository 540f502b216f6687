#pragma once
// Casters that random rays find late, because their shadows are small, although many viewpoints see them.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "casters/polygon_shadows.h"
#include "casters/shadow_batch.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Looks at the shadows of points of each polygon (polygon_shadows.h) from a few viewpoints. Returns what is missing
// there, in the order of polygons. A part of the polygon belongs to each point; where its shadow fills less than a
// share of what the viewpoints see, as estimated, no ray is cast. shadows: of the scene of `rays`. sets: asked from
// several threads. eyes: valid viewpoints, at least one. Each polygon is looked at from some of them, which `numbers`
// picks. least_share: of all directions, in the mean over the viewpoints, 0 .. 1. rays_cast: is increased by the number
// of rays. Runs on the calling thread's TBB arena; the result does not depend on the number of threads.
std::vector<missed_shadow> missed_shadows_of_polygons(const ray_scene& rays, const polygon_shadows& shadows,
                                                      const caster_sets& sets, std::span<const glm::vec3> eyes,
                                                      const verification_stream& numbers, double least_share,
                                                      std::uint64_t& rays_cast);

}  // namespace sightcell::bake
