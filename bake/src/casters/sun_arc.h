#pragma once
// The directions toward the sun that one caster set serves.
#include <array>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

#include "sightcell/bake/settings.h"
#include "sightcell/base/random.h"

namespace sightcell::bake {

// From one direction to another, as the sun moves; both are equal where it stands still. Unit vectors toward the sun.
struct sun_arc {
  glm::vec3 from{0.0f, 1.0f, 0.0f}, to{0.0f, 1.0f, 0.0f};

  bool stands_still() const { return from == to; }
  // Returns a direction of the arc. Takes no random number where the sun stands still.
  glm::vec3 draw(random_stream& random) const {
    return stands_still() ? from : glm::normalize(from + (to - from) * random.uniform());
  }
};

// Returns the direction toward a sun: degrees, clockwise from north (-z) as seen from above, and above the horizon.
inline glm::vec3 direction_to_sun(const std::array<double, 2>& azimuth_elevation) {
  const double azimuth = glm::radians(azimuth_elevation[0]), elevation = glm::radians(azimuth_elevation[1]);
  return glm::normalize(glm::vec3(glm::dvec3(glm::sin(azimuth) * glm::cos(elevation), glm::sin(elevation),
                                             -glm::cos(azimuth) * glm::cos(elevation))));
}

inline sun_arc arc_of(const sun_setting& sun) {
  return {direction_to_sun(sun.from), direction_to_sun(sun.to)};
}

}  // namespace sightcell::bake
