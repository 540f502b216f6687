#pragma once
// A look at one cell set from outside: the whole scene on the left, on the right only what the cell sees.
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>

#include "sightcell/picture/picture.h"

namespace headless_walk {

// A camera above and behind eye that takes in its surroundings.
sightcell::picture::camera camera_above(const sightcell::scene::world_geometry& world, const glm::vec3& eye);

// Two pictures of the same size side by side, with a thin line between them.
sightcell::picture::image_rgba side_by_side(const sightcell::picture::image_rgba& left,
                                            const sightcell::picture::image_rgba& right);

}  // namespace headless_walk
