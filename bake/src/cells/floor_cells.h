#pragma once
// Cells over floors: boxes that are as high as the eyes above the floor require.
#include <cstddef>
#include <cstdint>
#include <vector>

#include "cells/lattice.h"

namespace sightcell::bake {

// A cell with view_cell::floor_area and view_cell::floor.
struct floor_cell {
  lattice_position position;
  double area = 0.0;
  double floor = 0.0;
};

// Layers of a lattice that contain the eyes above a piece of floor.
struct eye_layers {
  std::int64_t first = 0, end = 0;  // end is not one of them
  double area = 0.0;                // of the floor, square meters
  double floor = 0.0;               // its height, meters
};

// Adds the cells of one lattice column. Eyes whose layers overlap are in one cell, over however many floors. What would
// be higher than wide is cut into parts of nearly equal heights.
// eyes: of the column, in any order; sorted on return.
// column: gives x, z and the level; y is ignored.
void add_floor_cells(std::vector<eye_layers>& eyes, const lattice_position& column, std::vector<floor_cell>& cells);

// Doubles the width of cells, and the height of layers, until there are at most `most` cells.
// cells: of level 0, sorted by position, unique; become those of the returned lattice.
lattice widen_until(std::vector<floor_cell>& cells, lattice on, std::size_t most);

}  // namespace sightcell::bake
