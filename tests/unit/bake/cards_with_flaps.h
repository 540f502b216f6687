#pragma once
#include "unit/bake/tiny_scene.h"

namespace sightcell::test {

// Returns a wall of n x n cards at x = 5 that faces the origin. Behind each card is a flap that touches its lower
// corner and that no place before the wall sees. Of each three polygons the first two are the card.
inline tiny_scene cards_with_flaps(int n) {
  tiny_scene tiny;
  const tiny_scene::look sheet{scene::alpha_mode::opaque, true};
  const float step = 6.0f / static_cast<float>(n), width = 0.75f * step, inset = 0.2f * step, depth = 0.05f * step;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const glm::vec3 corner{5, step * static_cast<float>(i) - 3.0f, step * static_cast<float>(j) - 3.0f};
      const glm::vec3 along{0, 0, width}, up{0, width, 0};
      const glm::vec3 top = corner + glm::vec3{depth, width - inset, inset};
      tiny.quad(corner, corner + along, corner + along + up, corner + up, sheet);
      tiny.triangle(corner, top + glm::vec3{0, 0, width - 2 * inset}, top, sheet);
    }
  return tiny;
}

}  // namespace sightcell::test
