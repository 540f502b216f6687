#pragma once
// The lattice of automatic and grid cells: boxes that are cell_size wide and deep and half as high, anchored at the
// world origin. Cells of higher levels are wider (lattice_position). Code works with lattice positions and makes boxes
// at the end, so that adjacent cells have bitwise equal coordinates at their common side.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

// The lattice positions from first to last, both included.
struct lattice_range {
  lattice_position first, last;
  double count() const;  // a double, because the number may exceed 64 bits
};

class lattice {
 public:
  explicit lattice(double cell_size) : width_(cell_size), height_(cell_size / 2.0) {}

  double width() const { return width_; }
  double height() const { return height_; }
  // Returns the lattice of twice the cell size, and the position on it that contains position p of this one, the
  // quotient p / 2 rounded down.
  lattice coarser() const { return lattice(width_ * 2.0); }
  static lattice_position coarser(const lattice_position& p);
  // Returns the position of the next level that covers p: wider, and as high.
  static lattice_position wider(const lattice_position& p);

  // Returns the cells that share volume with a box.
  // min, max: in meters.
  // Throws sightcell::error (bad_input) "cells.too-far" if a position exceeds what single precision can distinguish.
  lattice_range overlapping(const glm::dvec3& min, const glm::dvec3& max) const;

  // Returns the view cell at p. Throws "cells.too-far" if its box has no volume in single precision.
  view_cell cell(const lattice_position& p) const;

 private:
  double width_, height_;
};

// A lattice cell and what view_cell::floor_area says of it.
struct floor_cell {
  lattice_position position;
  double area = 0.0;
};

// Doubles the cell size until there are at most `most` cells.
// cells: sorted by position, unique; becomes those of the returned lattice.
lattice coarsen_until(std::vector<floor_cell>& cells, lattice on, std::size_t most);

// Returns a 64-bit hash of state and value, the same on every machine. Chained calls give view_cell::place, which names
// the random numbers of a cell.
std::uint64_t mix(std::uint64_t state, std::uint64_t value);

}  // namespace sightcell::bake
