#pragma once
// The first step of a bake: reads the overrides and reported misses, and flattens the scene.
#include <optional>

#include "cells/overrides.h"
#include "cells/view_cell.h"
#include "misses/reported_misses.h"
#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Everything that a bake reads, before anything is built from it.
struct bake_input {
  overrides given;                 // of the cells file
  reported_misses misses;          // of the misses file
  scene::world_geometry geometry;  // both scenes with how.cells_from, overrides applied
  std::optional<cell_list> cells;  // all cells of how.cells_from; nothing: they are made from geometry
};

// Reads and flattens what the settings name. Checks how.memory before and after flattening.
// Throws sightcell::error: "settings.no-such-group", "bake.memory", "bake.nothing-to-see", and what the readers of the
// files throw.
bake_input load_input(const scene::scene& s, const settings& how);

}  // namespace sightcell::bake
