#pragma once
// Cells on a lattice -> bytes. cell_lattice.h is the way back.
#include <cstddef>
#include <span>
#include <vector>

#include "sightcell/format/cell_lattice.h"
#include "sightcell/format/writer.h"

namespace sightcell::format {

// Appends the lattice. False, and nothing appended, when the places are not in that order, one is there twice, or a
// cell's box is none.
[[nodiscard]] bool put_lattice(const lattice_shape& shape, std::span<const lattice_place> places,
                               std::vector<std::byte>& out);

}  // namespace sightcell::format
