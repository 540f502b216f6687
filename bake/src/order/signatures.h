#pragma once
// Visibility signatures of the polygons of a unit: a bit for each (draw, cell) in which the draw is partly visible.
// Polygons with one signature are an atom: nothing is won by anything between them.
#include <cstdint>
#include <span>
#include <vector>

#include "order/bit_matrix.h"
#include "order/neighbor_lists.h"
#include "order/polygon_order.h"

namespace sightcell::bake {

// A unit's atoms, numbered by their first polygon, and their signatures.
struct unit_signatures {
  std::uint32_t polygon_count = 0;
  std::uint64_t column_count = 0;  // before folding
  // Polygons of atom a, ascending: members[begins[a]] .. members[begins[a + 1] - 1]
  std::vector<std::uint32_t> members, begins;
  // One row per atom, then the rows of what comes before and after the unit: nothing that any cell sees, as long as
  // set_surroundings says nothing else.
  bit_matrix rows;

  std::uint32_t atom_count() const { return static_cast<std::uint32_t>(begins.size()) - 1; }
  // The polygons of the unit, atoms in this order.
  std::vector<std::uint32_t> polygons_of(std::span<const std::uint32_t> atoms) const;
};

// Reads all sets twice: for the hashes that tell atoms apart (128 bits), then for the matrices.
std::vector<unit_signatures> read_signatures(const order_input& in, std::uint32_t sketch_bits);

// The polygons (numbers as in the input's draws; no_row: none) between which a draw lies.
struct surroundings {
  std::uint32_t before = no_row, after = no_row;
};

// Makes the last two rows of each unit say for each (draw, cell) whether the cell sees what is before and after that
// draw. Reads all sets once.
void set_surroundings(const order_input& in, std::span<const surroundings> by_draw, std::span<unit_signatures> units);

// For each given polygon (no_row: never seen) a row that says which cells see it. Reads all sets once.
bit_matrix cells_that_see(const order_input& in, std::span<const std::uint32_t> polygons, std::uint32_t sketch_bits);

}  // namespace sightcell::bake
