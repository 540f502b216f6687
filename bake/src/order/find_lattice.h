#pragma once
// Where a file's cells lie on a lattice.
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::bake {

struct cells_on_lattice {
  format::lattice_shape shape;
  std::vector<std::uint32_t> cells;           // numbers of the cells, in the order in which a file has them
  std::vector<format::lattice_place> places;  // [i]: of cells[i]
};

// Nothing unless settings, a file's settings text, name automatic or grid cells and each box is that of a lattice cell
// of its cell size, or of one twice as large or further coarsened, to the last bit. Cells by hand keep their numbers.
std::optional<cells_on_lattice> find_lattice(std::span<const format::box> cells, std::string_view settings);

}  // namespace sightcell::bake
