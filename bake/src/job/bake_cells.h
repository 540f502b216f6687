#pragma once
// The cells of a bake with everything that is derived from them alone.
#include <optional>

#include "cells/cell_blocks.h"
#include "cells/view_cell.h"
#include "job/bake_input.h"
#include "sightcell/bake/settings.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

struct bake_cells {
  // Makes the cells from input.geometry, or takes input.cells. Does not read the ray scene.
  // Throws sightcell::error on a broken cells file.
  bake_cells(const bake_input& input, const settings& how);

  // Of all cells, including those that how.cell_limit leaves out. Declared before list: making the list fills it in.
  std::optional<volume_grid> volumes;
  cell_list list;      // at most how.cell_limit cells
  cell_blocks blocks;  // of list
};

}  // namespace sightcell::bake
