#pragma once
// Where in a cell an eye can be.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "sightcell/base/box.h"
#include "sightcell/base/random.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Uniform free points of a box by rejection. tries is raised by every place that was tested; stops at wanted points or
// when max_tries places were tested, whichever is first.
std::vector<glm::vec3> draw_viewpoints(const ray_scene& rays, const box& where, float radius, std::size_t wanted,
                                       std::uint64_t max_tries, random_stream& random, std::uint64_t& tries);

// Is the polygon's front (either side, if it is seen from both) toward the eye?
bool faces(const ray_scene& rays, std::uint32_t polygon, const glm::vec3& eye);

}  // namespace sightcell::bake
