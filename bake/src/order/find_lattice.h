#pragma once
// Finds the lattice positions of the cells of a file, or their places on a grid.
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::bake {

struct cells_on_lattice {
  format::lattice_shape shape;
  std::vector<std::uint32_t> cells;           // cell numbers, in the order of a file
  std::vector<format::lattice_place> places;  // places[i] is that of cells[i]
};

// Returns the lattice positions of cells. Returns nothing unless the settings text of the file names automatic or grid
// cells, and each box equals bitwise that of a cell on a lattice of the cell size times powers of two. Explicit cells
// keep their numbers.
std::optional<cells_on_lattice> find_lattice(std::span<const format::box> cells, std::string_view settings);

struct cells_on_grid {
  format::lattice_shape step;
  std::vector<format::grid_box> places;  // one per cell, in the same order
};

// Returns the places of cells on a grid whose step is as wide as the narrowest cell, and as high as a layer of the
// lattice of the bake. Returns nothing unless the settings text of the file names automatic or grid cells, and each box
// equals bitwise one of whole steps.
std::optional<cells_on_grid> find_grid(std::span<const format::box> cells, std::string_view settings);

}  // namespace sightcell::bake
