#pragma once
// The wider cells that cells over floors can be merged to.
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cells/lattice.h"

namespace sightcell::bake {

// A cell over floors, or a wider one around such cells.
struct merge_node {
  lattice_position position;
  std::size_t parent = 0;    // index of the node that contains it; its own index at the top
  std::uint64_t floors = 0;  // columns of level 0 that have floor in it: bit 8 (z mod 8) + x mod 8
  bool may_be_cell = false;
};

// Returns the cells, in the given order, then the nodes of level 1 around them, and so on to the highest level. A node
// is around all nodes of the level below in its 2 x 2 columns whose heights overlap, directly or through each other. It
// may be a cell if at least half of its columns have floor, because otherwise most of the places in it would be places
// that no player reaches, and if it is at most as high as wide.
// cells: of level 0.
// highest: level of the top nodes, at most 3.
// Deterministic; the nodes of a level are sorted by their columns, from the lowest up.
std::vector<merge_node> make_merge_tree(std::span<const lattice_position> cells, std::int32_t highest);

// A part of one column of level 0, in layers.
struct column_part {
  std::int64_t z = 0, x = 0;
  std::int64_t first = 0, end = 0;
};

// Returns what is in a node and in none of the nodes of the level below: columns without floor, and what is above and
// below the cells of a slope. Sorted.
std::vector<column_part> uncovered_by_children(std::span<const merge_node> tree, std::size_t node,
                                               std::span<const std::size_t> children);

}  // namespace sightcell::bake
