#pragma once
// Valid viewpoints in a box, and facing of polygons.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"
#include "trace/viewpoint_region.h"

namespace sightcell::bake {

// Returns uniformly distributed valid viewpoints of a box or of a region of it, by rejection sampling.
// radius: player radius in meters.
// wanted: the search stops when it has this number of viewpoints.
// max_tries: or when it has tested this number of points.
// random: advanced by the points drawn.
// tries: increased by the number of points tested.
std::vector<glm::vec3> draw_viewpoints(const ray_scene& rays, const viewpoint_region& where, float radius,
                                       std::size_t wanted, std::uint64_t max_tries, random_stream& random,
                                       std::uint64_t& tries);

// Returns whether a polygon faces a viewpoint: its front does, or it is visible from both sides.
bool faces(const ray_scene& rays, std::uint32_t polygon, const glm::vec3& eye);

}  // namespace sightcell::bake
