#pragma once
// Chooses how large cells are: the fewest cells with which little more is drawn than with the smallest ones.
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace sightcell::bake {

// A cell that a bake may have. Options form trees: each covers the options whose parent it is, and nothing else.
struct cell_option {
  static constexpr double not_a_cell = std::numeric_limits<double>::infinity();

  std::size_t parent = 0;  // index of the option that covers it, which comes later in the list; its own at the top
  bool smallest = false;   // covers no other option
  // The number of polygons visible from the cell, times the floor area below the eyes in it: what it adds to the
  // polygons that a player draws, in the mean over the floor. not_a_cell: is only there for what it covers.
  double drawn = not_a_cell;
};

// Chooses cells that cover the smallest options, each once.
// growth: the sum of `drawn` over the cells chosen is at most 1 + growth times that over the smallest options.
// Returns their indices, ascending. The cells are the fewest for what is drawn: no choice of as many cells draws less.
//   They minimize sum(drawn) + price x cells, which is a pruning of each tree from its leaves up (Breiman, Friedman,
//   Olshen and Stone 1984, section 3.3), with the highest price that the growth allows, found by bisection.
// Cost: about a hundred passes over the options, 40 bytes for each.
std::vector<std::size_t> choose_cell_sizes(std::span<const cell_option> options, double growth);

}  // namespace sightcell::bake
