#pragma once
// Where the viewer begins: where there is something to see.
#include <glm/vec3.hpp>
#include <span>

#include "controls.h"
#include "triangle_tree.h"

namespace viewer {

// Returns a level view from one of some eyes along the longest free line that ends at a triangle. Where no line ends at
// one, a view from the first eye.
// eyes: at least one. Of many, only some that are spread over them are tried.
fly_camera best_view(const triangle_tree& scene, std::span<const glm::vec3> eyes);

// Returns the number of the eye that is nearest to a point. There are eyes.
std::size_t nearest_eye(std::span<const glm::vec3> eyes, const glm::vec3& point);

}  // namespace viewer
