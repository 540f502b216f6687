#pragma once
// Finds where a player can walk: floors with head room, found by Recast in a voxel field.
#include <string>
#include <vector>

#include "cells/lattice.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

inline constexpr double eye_height = 1.6;  // meters above the floor
inline constexpr double head_room = 1.8;   // meters that must be empty above a floor

struct walkable_cells {
  std::vector<lattice_position> positions;  // sorted, unique; empty if no floor was found
  lattice on{1.0};                          // coarser than requested if the scene is too wide
  std::vector<std::string> warnings;        // one line each
};

// Returns the lattice cells that contain an eye above an up-facing floor (slope at most 45 degrees) with head room.
// Opaque and MASK polygons are floors and obstacles; BLEND polygons (glass, water) are neither.
// on: the requested lattice.
// all_double_sided: down-facing polygons are floors as well.
// Deterministic. Memory is bounded by the size of the voxel field, not by the extent of the scene.
walkable_cells find_walkable_cells(const scene::world_geometry& geometry, lattice on, bool all_double_sided);

}  // namespace sightcell::bake
