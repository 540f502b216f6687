#pragma once
// The direction toward a sun.
#include <array>
#include <cmath>
#include <glm/trigonometric.hpp>
#include <glm/vec3.hpp>

namespace sightcell::bake {

// Returns a unit vector. azimuth_elevation: as in sun_setting, degrees.
inline glm::dvec3 toward_sun(const std::array<double, 2>& azimuth_elevation) {
  const double azimuth = glm::radians(azimuth_elevation[0]), elevation = glm::radians(azimuth_elevation[1]);
  return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation), -std::cos(azimuth) * std::cos(elevation)};
}

}  // namespace sightcell::bake
