#pragma once
// The cells of a bake with everything that is derived from them alone.
#include <optional>
#include <vector>

#include "cells/cell_blocks.h"
#include "cells/view_cell.h"
#include "job/bake_input.h"
#include "sightcell/bake/settings.h"
#include "sightcell/base/stop_request.h"
#include "volumes/volume_grid.h"

namespace sightcell::bake {

// Returns all cells of a bake, before they are merged and before how.cell_limit: input.cells, or those made from
// input.geometry. Does not read the ray scene.
// stop: null for none. Throws step_stopped if it was asked, and sightcell::error on a broken cells file.
cell_list all_cells(const bake_input& input, const settings& how, const stop_request* stop = nullptr);

struct bake_cells {
  // all: from all_cells(), merged or not. how.cell_limit is applied.
  // boxes: the cells of all_cells() before they were merged, for volumes.
  bake_cells(const bake_input& input, cell_list all, std::vector<view_cell> boxes, const settings& how);

  // Of all cells, including those that how.cell_limit leaves out.
  std::optional<volume_grid> volumes;
  cell_list list;      // at most how.cell_limit cells
  cell_blocks blocks;  // of list
};

}  // namespace sightcell::bake
