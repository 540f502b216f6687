#pragma once
// The directions toward the sun that one caster set serves.
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "input/sun_direction.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {

// From one direction to another, as the sun moves; both are equal where it stands still. Unit vectors toward the sun.
struct sun_arc {
  glm::vec3 from{0.0f, 1.0f, 0.0f}, to{0.0f, 1.0f, 0.0f};

  bool stands_still() const { return from == to; }
  // Returns the direction between both.
  glm::vec3 middle() const { return glm::normalize(from + to); }
  // Returns a direction of the arc. Takes no random number where the sun stands still.
  glm::vec3 draw(random_stream& random) const {
    return stands_still() ? from : glm::normalize(from + (to - from) * random.uniform());
  }
};

inline sun_arc arc_of(const sun_setting& sun) {
  return {glm::normalize(glm::vec3(toward_sun(sun.from))), glm::normalize(glm::vec3(toward_sun(sun.to)))};
}

}  // namespace sightcell::bake
