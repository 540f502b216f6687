#pragma once
// Visibility signatures of the polygons of a unit. There is one column for each (draw, cell) for which the set of the
// cell has some polygons of the draw and not all; the bit of a polygon is set if it is among them. Polygons with equal
// signatures form an atom. They stay adjacent, because placing other polygons between them gains nothing.
#include <cstdint>
#include <span>
#include <vector>

#include "order/bit_matrix.h"
#include "order/neighbor_lists.h"
#include "order/polygon_order.h"

namespace sightcell::bake {

// The atoms of a unit, numbered by their first polygon, and their signatures.
struct unit_signatures {
  std::uint32_t polygon_count = 0;
  std::uint64_t column_count = 0;  // before folding
  // The polygons of atom a, ascending, are members[begins[a]] .. members[begins[a + 1] - 1].
  std::vector<std::uint32_t> members, begins;
  // One row per atom, then two rows for what is before and after the unit. These are 0, in no set, until
  // set_surroundings() changes them.
  bit_matrix rows;

  std::uint32_t atom_count() const { return static_cast<std::uint32_t>(begins.size()) - 1; }
  // Returns the polygons of the unit, with the atoms in the given order.
  std::vector<std::uint32_t> polygons_of(std::span<const std::uint32_t> atoms) const;
};

// Computes the signatures of all units. It reads all sets twice: for 128-bit hashes that distinguish atoms, and for the
// matrices.
std::vector<unit_signatures> read_signatures(const order_input& in, std::uint32_t sketch_bits);

// The polygons before and after a draw, numbered as in the draws of the input; no_row: none.
struct surroundings {
  std::uint32_t before = no_row, after = no_row;
};

// Fills the last two rows of each unit: for each (draw, cell), whether the set of the cell has the polygon before and
// the polygon after that draw. It reads all sets once.
void set_surroundings(const order_input& in, std::span<const surroundings> by_draw, std::span<unit_signatures> units);

// Returns a matrix with one row per given polygon and a bit for each cell whose set has it. no_row is in no set. Reads
// all sets once.
bit_matrix cells_that_see(const order_input& in, std::span<const std::uint32_t> polygons, std::uint32_t sketch_bits);

}  // namespace sightcell::bake
