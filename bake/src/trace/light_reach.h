#pragma once
// What of a scene is inside the range and the cone of a light. Occluders do not count here.
#include <glm/vec3.hpp>

#include "sightcell/scene/scene.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

inline glm::vec3 position_of(const scene::light& light) {
  return {light.position[0], light.position[1], light.position[2]};
}

// Returns whether a point is inside the range and the cone.
bool is_in_reach(const scene::light& light, const glm::vec3& point);

// Returns false only if no point of a triangle is nearer than `slack` meters to the range and the cone.
bool may_reach(const scene::light& light, const triangle& corners, float slack);

}  // namespace sightcell::bake
