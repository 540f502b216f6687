#pragma once
// View cells: boxes a camera can be in.
#include <compare>
#include <cstdint>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "sightcell/bake/settings.h"
#include "sightcell/scene/scene.h"

namespace sightcell::bake {

// Members stand in the order cells are sorted by: z, then y, then x.
struct lattice_position {
  std::int64_t z = 0, y = 0, x = 0;
  auto operator<=>(const lattice_position&) const = default;
};

struct view_cell {
  glm::vec3 min{0.0f}, max{0.0f};  // metres, half-open, not grown
  std::string name;                // from a cells file; else empty
  std::uint64_t place = 0;   // names the cell's random numbers: a hash of its lattice position, or of the six floats
  std::uint32_t number = 0;  // of cells given by hand: their place in the list
  bool on_lattice = false;
  lattice_position position{};  // where it is
};

struct cell_list {
  std::vector<view_cell> cells;
  std::string how;                    // one line for people: "1,204 cells of 4 m over walkable floor"
  std::vector<std::string> warnings;  // one line each
};

// The cells that settings ask for: the host's own, else --cells-file, else --cells-grid, else automatic: lattice cells
// (cell_size wide and deep, half as high, anchored at the world's origin) that hold an eye 1.6 m above an up-facing
// floor with head room; where no floor is found, a grid over the bounding box grown by 2 m. Deterministic; --cell-limit
// is applied. Whether a cell has a free point is not asked here. Throws sightcell::error (bad_input) on a broken cells
// file.
cell_list make_cells(const scene::world_geometry& geometry, const settings& how);
// In two steps: without --cell-limit, and so many of them, spread evenly; 0: all.
cell_list make_all_cells(const scene::world_geometry& geometry, const settings& how);
void limit_cells(cell_list& list, std::uint32_t limit);

}  // namespace sightcell::bake
