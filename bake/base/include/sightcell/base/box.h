#pragma once
#include <glm/vec3.hpp>

namespace sightcell::bake {

// An axis-aligned box, in meters of world space.
struct box {
  glm::vec3 min{0.0f}, max{0.0f};
  // Returns the box with every side moved outward by `by` meters.
  box grown(float by) const { return {min - by, max + by}; }
};

}  // namespace sightcell::bake
