#pragma once
// Which rays go about the same way, so that they can share a packet.
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

}  // namespace sightcell::bake
