#pragma once
// The memory limit of a bake (--memory): estimates what a bake takes before it takes it. How the figures were measured:
// docs/baking.md, "Memory and disk".
#include <cstddef>
#include <cstdint>

#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Return the resident memory of this process in bytes: now, and the maximum so far. 0 if the system does not report it.
std::uint64_t resident_memory();
std::uint64_t peak_resident_memory();

// Returns the bytes of what is built before the first cell: the flattened scene, trees for rays, neighbors, the source
// of hemicubes. An upper estimate.
std::uint64_t memory_of_scene(const scene::scene& s, const settings& how);

// Returns the bytes that each worker adds: its cell set of set_bytes, images, and the records that it reads.
std::uint64_t memory_of_worker(std::uint64_t polygons, std::uint64_t set_bytes, const settings& how);

// Returns the bytes that the search for walkable floors takes. 0 if the cells are given.
// width, depth: of the scene, in meters.
std::uint64_t memory_of_floors(double width, double depth, const settings& how);

// Throws sightcell::error "bake.memory" if how.memory is too little for the scene and one worker. To be called before
// anything is built, and again with the flattened scene, when its extent is known.
// flattened: null if the scene is not flattened yet.
void require_memory(const scene::scene& s, const settings& how, const scene::world_geometry* flattened = nullptr);

// Returns how many of these workers fit into what is left of how.memory, at least one. To be called when everything but
// the workers is built.
std::size_t workers_that_fit(std::size_t workers, std::uint64_t worker_bytes, const settings& how);

}  // namespace sightcell::bake
