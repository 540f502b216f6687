#pragma once
// Finds where a player can walk: floors with head room that can be reached, found in a voxel field of Recast.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cells/floor_cells.h"
#include "cells/lattice.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/stop_request.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

inline constexpr double eye_height = 1.6;  // meters above the floor, of a standing player

struct walkable_cells {
  std::vector<floor_cell> cells;      // sorted by position, unique; empty if no floor was found
  lattice on{1.0};                    // coarser than requested if the scene is too wide
  std::string how;                    // for messages: "over floors reached from the largest region"
  std::vector<std::string> warnings;  // one line each
};

// Returns the cells around the eyes above the floors that the player of the settings reaches: eyes from crouching to
// jumping height (player_settings), where the ceiling leaves room. Floors are up-facing polygons that are
// flat enough, with head room. Opaque and MASK polygons are floors and obstacles; BLEND polygons (glass, water) are
// neither.
// on: the requested lattice, over_floors().
// Starts of the flood: how.starts, else geometry.starts, else the largest region of connected floors. With
// how.reach == reach::everywhere each floor is reached.
// stop: null for none. Throws step_stopped if it was asked.
// Deterministic. Memory is bounded by the size of the voxel field, not by the extent of the scene.
walkable_cells find_walkable_cells(const scene::world_geometry& geometry, lattice on, const settings& how,
                                   const stop_request* stop = nullptr);

}  // namespace sightcell::bake
