#pragma once
// The parts of masked polygons that a ray can hit. Leaves are mostly transparent: in a forest two of three hits of rays
// on masked polygons are where the alpha test is known to fail. Trees over these parts have few such hits.
#include <cstdint>
#include <span>
#include <vector>

#include "sightcell/scene/opacity_maps.h"
#include "trace/triangle_math.h"

namespace sightcell::bake {

// A triangle in a masked polygon: all of it, a quarter (between the middles of its edges), or a quarter of a quarter.
// In barycentric coordinates of the second and the third corner of the polygon its corners are (u, v), (u + size, v)
// and (u, v + size). A quarter in the middle is turned by 180 degrees: its size is negative.
struct masked_part {
  float u = 0.0f, v = 0.0f, size = 1.0f;
};

// Returns the corners of a part, from those of its polygon. Those on an edge of the polygon do not depend on the order
// in which the polygon has its corners.
inline triangle corners_of_part(const triangle& polygon, const masked_part& part) {
  const auto at = [&](float u, float v) { return polygon[0] * (1.0f - u - v) + polygon[1] * u + polygon[2] * v; };
  return {at(part.u, part.v), at(part.u + part.size, part.v), at(part.u, part.v + part.size)};
}

// The parts of the polygons of a scene. Together they cover all of a polygon that may pass its alpha test, and about as
// much again of it that does not. A polygon of which nothing is known is one part.
class masked_parts {
 public:
  // maps: must outlive the object.
  // Allocates at most 16 parts for each map.
  // Cost: linear in the parts of the maps.
  explicit masked_parts(const scene::opacity_maps& maps);

  // Returns the parts of a polygon; none where the test fails everywhere.
  // masked: index in world_geometry::masked.
  std::span<const masked_part> of(std::size_t masked) const;

 private:
  const scene::opacity_maps& maps_;
  std::vector<std::uint32_t> begins_;  // by map: its first entry in parts_
  std::vector<masked_part> parts_;
};

}  // namespace sightcell::bake
