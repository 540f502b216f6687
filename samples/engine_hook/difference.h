#pragma once
// What a picture shows, pixel by pixel, and where two of them show something else.
#include <cstdint>
#include <vector>

namespace engine_hook {

inline constexpr float near_plane = 0.001f;  // meters; as near as the bake looks

struct picture {
  std::vector<std::uint32_t> surfaces;  // the nearest solid surface: its unit + 1; 0: none
  std::vector<float> depths;            // of it: near_plane / meters along the view's axis; 0: none
  std::vector<float> layers;            // blended polygons in front of it
};

struct difference {
  std::uint64_t differing = 0;  // another place, or other layers before it
  std::uint64_t ties = 0;       // of surfaces in the same place, another unit's
};

// Polygon by polygon would say too much: where surfaces coincide, a cell set has to hold only one of them, so the two
// pictures may show different ones. The bake calls surfaces coincident that are no farther apart than
// max(0.2 mm, distance / 50,000): pixels that differ by less count as ties. For all else the place says which polygon
// it is: the same triangle under the same transform has bit for bit the same depth in all pictures.
difference compare(const picture& reference, const picture& other);

}  // namespace engine_hook
