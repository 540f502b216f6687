#pragma once
// The order of cells and polygons in a file. Both are sorted after all sets are known.
#include <cstdint>
#include <functional>
#include <vector>

#include "order/stored_draws.h"
#include "sightcell/bake/file_settings.h"
#include "sightcell/format/file_parts.h"

namespace sightcell::bake {

// Sorts cells into lattice order, with their certificates and viewpoints, if the settings text of parts names a lattice
// and all cells are on it. Else as put_on_grid().
// Returns the previous number of each cell; empty if the cells were not sorted.
std::vector<std::uint32_t> order_cells(format::file_parts& parts);

// Stores cells that are boxes as boxes on a grid, if the settings text of parts names a lattice and all cells are of
// whole steps. Cells keep their order: that of the bake, row by row, in which neighbors see much the same.
void put_on_grid(format::file_parts& parts);

// Appends the source ids of a cell, ascending, to an empty set.
using set_source = std::function<void(std::uint32_t cell, std::vector<std::uint32_t>& set)>;

// Replaces draws, order_of_draw and orders of parts.
void put(stored_draws stored, format::file_parts& parts);

// Computes a new order of polygons and draws, for the layout in the facts of parts. It replaces draws, order_of_draw
// and orders of parts.
// set_of: by the cell numbers of parts.
// Cost: that of store_draws() (stored_draws.h).
void order_polygons_of(format::file_parts& parts, polygon_order_kind kind, const set_source& set_of);

}  // namespace sightcell::bake
