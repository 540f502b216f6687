#pragma once
// Sort keys that place similar rays and nearby points next to each other, so that they share ray packets.
#include <cstdint>
#include <glm/vec3.hpp>

namespace sightcell::bake {

// Returns a 15-bit key of a unit vector: five bits of each component, interleaved (Morton 1966). Similar directions
// tend to have close keys.
inline std::uint32_t direction_code(const glm::vec3& direction) {
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto part = static_cast<std::uint32_t>((direction[axis] + 1.0f) * 15.99f);
    for (std::uint32_t bit = 0; bit < 5; ++bit)
      code |= (part >> bit & 1u) << (3 * bit + static_cast<std::uint32_t>(axis));
  }
  return code;
}

// Returns a 15-bit key of a point in a box: its position relative to the box, coded as by direction_code().
// min, size: lower corner and extent of the box in meters. An axis of extent 0 is ignored.
inline std::uint32_t place_code(const glm::vec3& place, const glm::vec3& min, const glm::vec3& size) {
  glm::vec3 part{0.0f};
  for (int axis = 0; axis < 3; ++axis)
    if (size[axis] > 0.0f) part[axis] = 2.0f * (place[axis] - min[axis]) / size[axis] - 1.0f;
  return direction_code(part);
}

}  // namespace sightcell::bake
