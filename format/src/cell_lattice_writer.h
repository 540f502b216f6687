#pragma once
// Cells on a lattice -> bytes. cell_lattice.h is the way back.
#include <cstddef>
#include <span>
#include <vector>

#include "cell_lattice.h"

namespace sightcell::format {

// The order in which a file has its cells: by level, then chunk by chunk.
[[nodiscard]] bool comes_before(const lattice_place& a, const lattice_place& b) noexcept;

// Appends the lattice. False, and nothing appended, when the places are not in that order, one is there twice, or a
// cell's box is none.
[[nodiscard]] bool put_lattice(const lattice_shape& shape, std::span<const lattice_place> places,
                               std::vector<std::byte>& out);

}  // namespace sightcell::format
