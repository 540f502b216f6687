#pragma once
// In which order polygons are stored, so that the sets of cells are few runs: what is seen together lies together.
//
// Inside each unit (a stretch of polygons that is free to be permuted) the order is a short travelling salesman's path
// over the Hamming distance of visibility signatures: which cells see a polygon, for each of the unit's draws. A second
// path lays the draws end to end, and then both are fitted to each other.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::bake {

// A stretch of consecutive polygons that stays together: a draw of the instanced layout, a draw group of the merged
// one. Draws with the same unit share one order (instances of one primitive) and have the same count.
struct ordered_draw {
  std::uint32_t unit = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

struct order_input {
  // Ascending first, gapless from 0.
  std::span<const ordered_draw> draws;
  std::uint32_t unit_count = 0;
  std::uint32_t cell_count = 0;
  // Puts the set of a cell as runs (ascending, disjoint, not touching; numbers as in draws) into runs, which comes
  // empty. Called from one thread, several times for each cell (3 + 2 * rounds), ascending; it must answer the same
  // each time. What it throws comes through.
  std::function<void(std::uint32_t cell, std::vector<format::run>& runs)> runs_of;
};

struct order_settings {
  std::uint32_t sorts = 16;     // that propose neighbors
  std::uint32_t neighbors = 8;  // kept per signature
  // Widest signature, at most 65536; wider ones are folded (column -> hash % bits, exclusive or), which keeps small
  // distances.
  std::uint32_t sketch_bits = 2048;
  std::uint32_t rounds = 2;  // of fitting units and draws to each other
};

struct polygon_order {
  // units[u][i]: which polygon of the unit (0 .. count - 1, as in its source order) comes i-th. Empty for a unit
  // without draws.
  std::vector<std::vector<std::uint32_t>> units;
  // Draw numbers in the order in which they are laid end to end; draws with count 0 come last in ascending order.
  std::vector<std::uint32_t> draws;
};

// The order depends on nothing but input and settings: no thread, pointer or time. Works on as many threads as oneTBB
// gives it, units side by side and the long loops of large ones.
//
// Memory: w = min(sketch_bits, widest unit's columns) / 8 bytes for each of A atoms (polygons of a unit with the same
// signature), 16 for each polygon of the units; 20 * neighbors + 60 for each atom of the units worked on at once; twice
// sketch_bits / 8 for each draw. Measured: 3 million atoms and 2,000 cells 1.4 GiB. Sets are never kept.
polygon_order order_polygons(const order_input& in, const order_settings& how);

}  // namespace sightcell::bake
