#pragma once
// The lattice of automatic and grid cells: boxes that are cell_size wide and deep, anchored at the world origin. A cell
// of a grid is one layer, which is half as high. Over floors a layer is an eighth as high, and a cell has several.
// Cells of higher levels are wider (lattice_position). Code works with lattice positions and makes boxes at the end, so
// that adjacent cells have bitwise equal coordinates at their common side.
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
  // The lattice of a grid.
  explicit lattice(double cell_size) : lattice(cell_size, cell_size / 2.0) {}
  // The lattice of cells over floors.
  static lattice over_floors(double cell_size) { return {cell_size, cell_size / layers_per_width}; }
  // A cell over a floor of level 0 has at most this number of layers: it is at most as high as wide.
  static constexpr std::int32_t layers_per_width = 8;

  double width() const { return width_; }
  double height() const { return height_; }  // of a layer
  // Returns the lattice of twice the cell size.
  lattice coarser() const { return {width_ * 2.0, height_ * 2.0}; }

  // Returns the cells that share volume with a box.
  // min, max: in meters.
  // Throws sightcell::error (bad_input) "cells.too-far" if a position exceeds what single precision can distinguish.
  lattice_range overlapping(const glm::dvec3& min, const glm::dvec3& max) const;

  // Returns whether the box at p has volume in single precision.
  bool has_volume(const lattice_position& p) const;
  // Returns the view cell at p. Throws "cells.too-far" if its box has no volume in single precision.
  view_cell cell(const lattice_position& p) const;

 private:
  lattice(double width, double height) : width_(width), height_(height) {}
  // Sets the corners of a box.
  void set_box(const lattice_position& p, view_cell& cell) const;

  double width_, height_;
};

// Returns a 64-bit hash of state and value, the same on every machine. Chained calls give view_cell::place, which names
// the random numbers of a cell.
std::uint64_t mix(std::uint64_t state, std::uint64_t value);

}  // namespace sightcell::bake
