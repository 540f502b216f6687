#pragma once
// An order of polygons that does not depend on their numbers.
#include <cstdint>
#include <vector>

#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Sorts polygons by the coordinates of their corners, and polygons with the same corners by number. Trees over a scene
// depend on the order of its polygons, and in rare cases so does what is found with them: which of two polygons a ray
// along their edge hits, or a pixel shows where both have the same depth. Trees that are built in this order are those
// of each file with the same geometry, in whatever order a tool wrote it.
// polygons: source ids of the scene.
// Allocates 16 bytes per polygon. Uses the caller's TBB arena; the result does not depend on it. Takes about 0.1 s of
// CPU time per million polygons.
void sort_by_place(const scene::world_geometry& world, std::vector<std::uint32_t>& polygons);

}  // namespace sightcell::bake
