#pragma once
// Unverified dilation: what lies beside the polygons of a cell set, whether it is seen or not (--safety-ring).
#include <cstdint>
#include <span>
#include <vector>

#include "search/vertex_neighbors.h"
#include "sightcell/bake/safety_ring.h"
#include "sightcell/base/box.h"
#include "trace/ray_scene.h"

namespace sightcell::bake {

// What shares a welded edge or vertex with a member, is none, and faces some place of the box; ascending, each once.
// set: ascending. One ring: what is beside the ring itself stays out.
std::vector<std::uint32_t> ring_of(const ray_scene& rays, const vertex_neighbors& sharing, safety_ring how,
                                   const box& grown, std::span<const std::uint32_t> set);

}  // namespace sightcell::bake
