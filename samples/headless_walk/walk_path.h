#pragma once
// The frames of a walk: where the eye stands and looks.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "free_place.h"

namespace headless_walk {

struct step {
  glm::vec3 eye, forward;
};

// Visits the boxes, always the nearest one next, and spreads the frames evenly over them: with fewer frames than boxes
// some are left out, with more the eye looks around in each. In a box with a known eye
// it stays there. Boxes without a valid viewpoint are skipped; their number is
// added to skipped.
std::vector<step> make_path(const sightcell::scene::world_geometry& world, const std::vector<box>& boxes,
                            std::uint32_t frames, std::uint32_t& skipped);

}  // namespace headless_walk
