#pragma once
// Chooses how large lattice cells are: the fewest cells with which little more is drawn than with the smallest ones.
#include <span>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

// A lattice cell that a bake may have.
struct cell_option {
  lattice_position position;
  // The number of polygons visible from the cell, times the floor area below the eyes in it: what it adds to the
  // polygons that a player draws, in the mean over the floor.
  double drawn = 0.0;
};

// Chooses cells that cover those of level 0, each once.
// options: each position once, in any order. Those of level 0 are the cells to be covered. Those of higher levels each
//   cover some of them.
// growth: the sum of `drawn` over the cells chosen is at most 1 + growth times that over level 0.
// Returns the positions, sorted. The cells are the fewest for what is drawn: no choice of as many cells draws less.
// They
//   minimize sum(drawn) + price x cells, which is a pruning of each quadtree from its leaves up (Breiman, Friedman,
//   Olshen and Stone 1984, section 3.3), with the highest price that the growth allows, found by bisection.
// Cost: O(n log n), some megabytes per 100,000 options. The result does not depend on the order of the options.
std::vector<lattice_position> choose_cell_sizes(std::span<const cell_option> options, double growth);

}  // namespace sightcell::bake
