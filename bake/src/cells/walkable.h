#pragma once
// Where people can stand: floors with head room, found by Recast in a field of voxels.
#include <string>
#include <vector>

#include "cells/lattice.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

inline constexpr double eye_height = 1.6;  // metres above the floor
inline constexpr double head_room = 1.8;   // metres that must be open above a floor

struct walkable_cells {
  std::vector<lattice_position> positions;  // sorted, unique; empty where no floor was found
  lattice on{1.0};                          // coarser than asked for where the scene is too wide
  std::vector<std::string> warnings;        // one line each
};

// The lattice cells that hold an eye above an up-facing floor (slope at most 45 degrees) with head room. Opaque and
// MASK polygons are floors and obstacles, BLEND (glass, water) is neither. all_double_sided: down-facing polygons are
// floors as well. Deterministic; memory is bounded by the field, not by the extent of the scene.
walkable_cells find_walkable_cells(const scene::world_geometry& geometry, lattice on, bool all_double_sided);

}  // namespace sightcell::bake
