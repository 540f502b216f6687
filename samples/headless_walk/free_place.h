#pragma once
// Where an eye can stand.
#include <glm/vec3.hpp>
#include <optional>

#include "sightcell/scene/scene.h"

namespace headless_walk {

struct box {
  glm::vec3 min, max;
  std::optional<glm::vec3> eye{};  // a valid viewpoint in it, if the file has one
};

// A place in the box, its middle if possible, that is not inside something solid: what is seen first along the six axes
// is no back of an opaque single-sided polygon and is at least clearance meters away. None when 64 tries find none.
std::optional<glm::vec3> find_free_place(const sightcell::scene::world_geometry& world, const box& where,
                                         float clearance);

}  // namespace headless_walk
