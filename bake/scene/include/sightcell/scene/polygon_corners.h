#pragma once
// Positions of the corners of a polygon as a key, to find polygons in the same place: equal bits, except that -0 is 0.
#include <algorithm>
#include <array>
#include <bit>
#include <compare>
#include <cstddef>
#include <cstdint>

#include "sightcell/scene/scene.h"

namespace sightcell::scene {

struct polygon_corners {
  using corner = std::array<std::uint32_t, 3>;  // the bits of x, y and z
  std::array<corner, 3> corners;

  auto operator<=>(const polygon_corners&) const = default;

  // Returns the key of the oriented polygon: the smallest corner first, same winding.
  polygon_corners rotated() const {
    const auto smallest = static_cast<std::size_t>(std::min_element(corners.begin(), corners.end()) - corners.begin());
    return {{corners[smallest], corners[(smallest + 1) % 3], corners[(smallest + 2) % 3]}};
  }

  // Returns the key of the polygon with any winding: corners in ascending order.
  polygon_corners sorted() const {
    polygon_corners all = *this;
    std::sort(all.corners.begin(), all.corners.end());
    return all;
  }
};

// Returns the corners of a polygon, in the order of its indices.
// polygon: source id.
inline polygon_corners corners_of(const world_geometry& geometry, std::uint32_t polygon) {
  polygon_corners found;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::vec3& p = geometry.positions[geometry.indices[3 * std::size_t{polygon} + i]];
    for (int axis = 0; axis < 3; ++axis)
      found.corners[i][static_cast<std::size_t>(axis)] = std::bit_cast<std::uint32_t>(p[axis] + 0.0f);  // -0 + 0 is 0
  }
  return found;
}

}  // namespace sightcell::scene
