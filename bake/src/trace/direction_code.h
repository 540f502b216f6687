#pragma once
// Which rays go about the same way, and which places are near each other, so that they can share a packet.
#include <cstdint>
#include <glm/vec3.hpp>

namespace sightcell::bake {

// Near numbers for near unit vectors: five bits of each component, interleaved (Morton 1966).
inline std::uint32_t direction_code(const glm::vec3& direction) {
  std::uint32_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto part = static_cast<std::uint32_t>((direction[axis] + 1.0f) * 15.99f);
    for (std::uint32_t bit = 0; bit < 5; ++bit)
      code |= (part >> bit & 1u) << (3 * bit + static_cast<std::uint32_t>(axis));
  }
  return code;
}

// Near numbers for near places of a box, by its lower corner and its size: the same of what is left of each component.
inline std::uint32_t place_code(const glm::vec3& place, const glm::vec3& min, const glm::vec3& size) {
  glm::vec3 part{0.0f};
  for (int axis = 0; axis < 3; ++axis)
    if (size[axis] > 0.0f) part[axis] = 2.0f * (place[axis] - min[axis]) / size[axis] - 1.0f;
  return direction_code(part);
}

}  // namespace sightcell::bake
