#pragma once
// Conservative dilation (--safety-ring): adds the neighbors of a cell set without a visibility test.
#include <cstdint>
#include <span>
#include <vector>

#include "search/vertex_neighbors.h"
#include "sightcell/bake/safety_ring.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// Returns the polygons outside the set that share a welded edge or vertex with a member and face some point of the
// box, ascending. Their own neighbors are not included.
// set: source ids, ascending.
std::vector<std::uint32_t> ring_of(const ray_scene& rays, const vertex_neighbors& sharing, safety_ring how,
                                   const box& grown, std::span<const std::uint32_t> set);

}  // namespace sightcell::bake
