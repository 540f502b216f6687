#include "cells/view_cell.h"
#include "job/bake_input.h"
#include "sightcell/bake/cells.h"

namespace sightcell::bake {

cell_preview preview_cells(const scene::scene& s, const settings& how) {
  validate(how);
  const bake_input input = load_input(s, how);
  const cell_list list = input.cells ? *input.cells : make_cells(input.geometry, how);
  cell_preview preview{.cells = {}, .how = list.how, .warnings = list.warnings};
  preview.cells.reserve(list.cells.size());
  for (const view_cell& cell : list.cells)
    preview.cells.push_back({cell.name, {cell.min.x, cell.min.y, cell.min.z}, {cell.max.x, cell.max.y, cell.max.z}});
  return preview;
}

}  // namespace sightcell::bake
