#pragma once
// Writes cells on a lattice. The counterpart for reading is cell_lattice.h.
#include <cstddef>
#include <span>
#include <vector>

#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// Appends the lattice. False, and nothing appended, if the shape is invalid, the positions are not in order, one occurs
// twice, or the level or the box of a cell is invalid.
[[nodiscard]] bool put_lattice(const lattice_shape& shape, std::span<const lattice_place> places,
                               std::vector<std::byte>& out);

}  // namespace sightcell::format
