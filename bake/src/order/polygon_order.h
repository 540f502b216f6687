#pragma once
// The order in which a file stores polygons. Polygons that are visible from the same cells are adjacent, so that cell
// sets are few runs.
//
// A unit is a sequence of polygons that may be permuted. Inside each unit the order is a short traveling salesman path
// over the Hamming distance of visibility signatures: the cells whose sets have the polygon, for each draw of the unit.
// A second path orders the draws. Then both are fitted to each other.
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sightcell/format/records.h"

namespace sightcell::bake {

// Consecutive polygons that stay together: a draw of the instanced layout, a draw group of the merged one. Draws with
// the same unit share one order (instances of one primitive) and have the same count.
struct ordered_draw {
  std::uint32_t unit = 0;
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};

struct order_input {
  // In ascending order of `first`, without gaps from 0.
  std::span<const ordered_draw> draws;
  std::uint32_t unit_count = 0;
  std::uint32_t cell_count = 0;
  // Appends the set of a cell as runs to an empty vector: ascending, disjoint, not adjacent, numbered as in draws. It
  // is called 3 + 2 * rounds times for each cell, for several cells at once, and must return the same each time. Its
  // exceptions reach the caller.
  std::function<void(std::uint32_t cell, std::vector<format::run>& runs)> runs_of;
};

struct order_settings {
  std::uint32_t sorts = 16;     // sorts that propose neighbors
  std::uint32_t neighbors = 8;  // neighbors that are kept per signature
  // Maximum number of bits of a signature, at most 65536. Wider signatures are folded (column to hash % bits, exclusive
  // or), which preserves small distances.
  std::uint32_t sketch_bits = 2048;
  std::uint32_t rounds = 2;  // rounds in which units and draws are fitted to each other
};

struct polygon_order {
  // units[u][i] is the polygon of unit u that is stored as number i of the unit; polygons are numbered 0 .. count - 1
  // in source order. Empty for a unit without draws.
  std::vector<std::vector<std::uint32_t>> units;
  // Draw numbers in stored order. Draws with count 0 are last, in ascending order.
  std::vector<std::uint32_t> draws;
};

// Computes the stored order. It depends on input and settings alone, not on threads, pointers or time.
// Threads: as many as oneTBB provides. Small units run in parallel; large units use several threads inside.
// Memory, with w = min(sketch_bits, columns of the widest unit) / 8: w bytes for each atom (polygons of a unit with the
// same signature), 16 bytes for each polygon of the units, 20 * neighbors + 60 bytes for each atom of the units in work
// at once, and 2 * sketch_bits / 8 bytes for each draw. Measured: 1.4 GiB for 3 million atoms and 2,000 cells. Sets are
// never kept.
polygon_order order_polygons(const order_input& in, const order_settings& how);

}  // namespace sightcell::bake
