#pragma once
// Writes cells on a grid. The counterpart for reading is grid_boxes.h.
#include <cstddef>
#include <span>
#include <vector>

#include "sightcell/format/grid_boxes.h"

namespace sightcell::format {

// Appends the grid. False, and nothing appended, if the size of a step or the box of a cell is invalid.
[[nodiscard]] bool put_grid(const lattice_shape& step, std::span<const grid_box> places, std::vector<std::byte>& out);

}  // namespace sightcell::format
