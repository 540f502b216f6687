#pragma once
// The cells that a bake decided on, and their bytes in a checkpoint: a resumed bake takes them from there.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

struct decided_cells {
  // What the cells were made from, as texts that other inputs do not have. Cells are valid for a bake with the same
  // two.
  std::string inputs;  // scene and settings
  std::string device;  // that rendered the cubes by which cells were merged
  cell_list list;      // automatic cells, merged or not, before how.cell_limit
  // The cells before they were merged, if the bake makes volumes of them, else empty. Only their boxes are of use.
  std::vector<view_cell> boxes;
};

// Returns the bytes of the cells.
// cells.list.can_merge: true. list.where is left out, because it is for merging.
std::string encode(const decided_cells& cells);

// Returns the cells that encode() was given; nothing if the bytes are not those of cells. Safe with any bytes: memory
// is in proportion to them, all numbers are finite, no two cells have the same position, and texts are single lines.
std::optional<decided_cells> decode_cells(std::string_view bytes);

}  // namespace sightcell::bake
