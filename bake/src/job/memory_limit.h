#pragma once
// --memory: what a bake takes, before it takes it. Figures and how they were measured: docs/baking.md, "Memory and
// disk".
#include <cstddef>
#include <cstdint>

#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Of this process now, and at most so far; bytes. 0 where the system cannot tell.
std::uint64_t resident_memory();
std::uint64_t peak_resident_memory();

// What is built of a scene before its first cell: the flattened scene, trees for rays and neighbors, the source of
// hemicubes. Rather too much than too little.
std::uint64_t memory_of_scene(const scene::scene& s, const settings& how);

// What each cell in work takes besides, with a set of set_bytes: the set, a place to draw in, records it reads.
std::uint64_t memory_of_lane(std::uint64_t polygons, std::uint64_t set_bytes, const settings& how);

// What is taken while automatic cells are looked for in a scene that is so wide; 0 where cells are given.
std::uint64_t memory_of_floors(double width, double depth, const settings& how);

// Throws sightcell::error "bake.memory" where how.memory is too little for the scene and one cell in work. Before any
// of it is built, and again when the scene is flattened, which tells how wide it is.
void require_memory(const scene::scene& s, const settings& how, const scene::world_geometry* flattened = nullptr);

// How many of these lanes fit into what is left of how.memory, at least one. After the scene was built.
std::size_t workers_that_fit(std::size_t lanes, std::uint64_t lane_bytes, const settings& how);

}  // namespace sightcell::bake
