#pragma once
// Finds the lattice positions of the cells of a file.
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
// cells, and each box equals bitwise that of a cell on a lattice of the cell size times powers of two. Where cells have
// several widths, it is a lattice of layers. Explicit cells keep their numbers.
std::optional<cells_on_lattice> find_lattice(std::span<const format::box> cells, std::string_view settings);

}  // namespace sightcell::bake
