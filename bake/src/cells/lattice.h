#pragma once
// The lattice that automatic and grid cells lie on: boxes cell_size wide and deep and half as high, anchored at the
// world's origin. Only places are kept here; boxes are made at the end, so that neighbors share the very same floats.
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "cells/view_cell.h"

namespace sightcell::bake {

// Cells from first to last, both included.
struct lattice_range {
  lattice_position first, last;
  double count() const;  // a double, because the product can be beyond 64 bits
};

class lattice {
 public:
  explicit lattice(double cell_size) : width_(cell_size), height_(cell_size / 2.0) {}

  double width() const { return width_; }
  double height() const { return height_; }
  // Twice the cell size: position p lies in position (floor(p / 2)) of the coarser lattice.
  lattice coarser() const { return lattice(width_ * 2.0); }
  static lattice_position coarser(const lattice_position& p);

  // The cells that share volume with a box. Throws sightcell::error (bad_input) "cells.too-far" where the lattice is
  // finer than the numbers it would need.
  lattice_range overlapping(const glm::dvec3& min, const glm::dvec3& max) const;

  // The view cell at p. Throws "cells.too-far" where its box has no volume in single precision.
  view_cell cell(const lattice_position& p) const;

 private:
  double width_, height_;
};

// Merges cells into a lattice of twice the size until there are at most `most`. positions stays sorted and unique.
// Gives the lattice that positions are on afterwards.
lattice coarsen_until(std::vector<lattice_position>& positions, lattice on, std::size_t most);

// Names random numbers: a well mixed 64-bit hash of a few integers, the same on every machine.
std::uint64_t mix(std::uint64_t state, std::uint64_t value);

}  // namespace sightcell::bake
